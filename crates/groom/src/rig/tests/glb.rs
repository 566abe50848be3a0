//! GLB files built in code.

use serde_json::{Value, json};

/// A GLB file under construction.
#[derive(Clone)]
pub struct Glb {
    /// JSON without the buffers.
    pub root: Value,
    /// Binary buffer.
    pub bin: Vec<u8>,
}

pub const F32: u32 = 5126;
pub const U8: u32 = 5121;
pub const U16: u32 = 5123;

impl Glb {
    pub fn new() -> Self {
        let root = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [], "meshes": [],
            "skins": [], "animations": [], "accessors": [], "bufferViews": [],
        });
        Self { root, bin: Vec::new() }
    }

    /// Appends to a list of the root. Returns the index in the list.
    pub fn push(&mut self, list: &str, item: Value) -> usize {
        let all = self.root[list].as_array_mut().unwrap();
        all.push(item);
        all.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend(bytes);
        self.push("bufferViews", view)
    }

    pub fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        // Positions require bounds, which the reader ignores.
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count,
            "min": [0, 0, 0], "max": [1, 1, 1]});
        self.push("accessors", accessor)
    }

    pub fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(F32, kind, values.len() / width, &bytes)
    }

    pub fn vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        self.floats(&format!("VEC{N}"), N, values.as_flattened())
    }

    pub fn shorts(&mut self, kind: &str, width: usize, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(U16, kind, values.len() / width, &bytes)
    }

    /// Overwrites an accessor's bytes from `at` on.
    pub fn poke(&mut self, accessor: usize, at: usize, bytes: &[u8]) {
        let view = self.root["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        let start = self.root["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize + at;
        self.bin[start..start + bytes.len()].copy_from_slice(bytes);
    }

    /// Adds one animation of one property with these times and values. Returns the sampler's input and output
    /// accessors.
    pub fn animate(
        &mut self,
        name: &str,
        node: usize,
        path: &str,
        how: &str,
        keys: (&[f32], &[f32]),
    ) -> [usize; 2] {
        let input = self.floats("SCALAR", 1, keys.0);
        let (kind, width) = match path {
            "rotation" => ("VEC4", 4),
            "weights" => ("SCALAR", 1),
            _ => ("VEC3", 3),
        };
        let output = self.floats(kind, width, keys.1);
        self.push(
            "animations",
            json!({"name": name,
            "samplers": [{"input": input, "output": output, "interpolation": how}],
            "channels": [{"sampler": 0, "target": {"node": node, "path": path}}]}),
        );
        [input, output]
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut root = self.root.clone();
        for list in ["meshes", "skins", "animations", "accessors", "bufferViews"] {
            if root[list].as_array().is_some_and(Vec::is_empty) {
                root.as_object_mut().unwrap().remove(list);
            }
        }
        root["buffers"] = json!([{"byteLength": self.bin.len()}]);
        pack(root.to_string().into_bytes(), self.bin.clone())
    }
}

/// Accessors of [`arm`].
pub struct Parts {
    pub joints: usize,
    pub weights: usize,
    pub inverse: usize,
    pub sparse: usize,
    pub bend: [usize; 2],
}

/// Builds an arm along x with an elbow at 1: vertices at the shoulder, over the elbow (half and half) and at the hand
/// (2); and a triangle without skin. Node 0 is the root, 1 the shoulder, 2 the elbow, 3 the arm's mesh, whose own
/// transform must be ignored, 4 the triangle's. Shape `Swell` lifts all vertices, `Hand` is sparse and moves the last.
/// Animations: `Bend`, `Step`, `Spline`, `Blend`.
pub fn arm() -> (Glb, Parts) {
    let mut glb = Glb::new();
    let positions = glb.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [2.0, 0.0, 0.0]]);
    let normals = glb.vectors(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let joints = glb.shorts("VEC4", 4, &[0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]);
    // The second vertex's weights sum to 2; the third's are 0, so only its first joint is used.
    let weights = glb.vectors(&[[1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]);
    let indices = glb.shorts("SCALAR", 1, &[0, 1, 2]);
    let swell = glb.vectors(&[[0.0, 0.0, 0.25]; 3]);
    let swell_normals = glb.vectors(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]);
    let at = glb.view(&[2, 0]);
    let to = glb.view(&[0.0f32, 0.5, 0.0].map(f32::to_le_bytes).concat());
    let sparse = glb.push(
        "accessors",
        json!({"componentType": F32, "type": "VEC3", "count": 3, "sparse": {
        "count": 1, "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": to}}}),
    );
    // An accessor without data is all zeros.
    let nothing = glb.push("accessors", json!({"componentType": F32, "type": "VEC3", "count": 3}));
    glb.push("meshes", json!({"extras": {"targetNames": ["Swell", "Hand"]}, "primitives": [{"attributes":
        {"POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights}, "indices": indices,
        "targets": [{"POSITION": swell, "NORMAL": swell_normals}, {"POSITION": sparse, "NORMAL": nothing}]}]}));
    let still = glb.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let up = glb.vectors(&[[0.0, 0.0, 1.0]; 3]);
    glb.push("meshes", json!({"primitives": [{"attributes": {"POSITION": still, "NORMAL": up}}]}));
    let mut inverse = glam::Mat4::IDENTITY.to_cols_array().to_vec();
    inverse.extend(glam::Mat4::from_translation(glam::vec3(-1.0, 0.0, 0.0)).to_cols_array());
    let inverse = glb.floats("MAT4", 16, &inverse);
    glb.push("skins", json!({"joints": [1, 2], "inverseBindMatrices": inverse}));
    glb.root["nodes"] = json!([{"name": "Root", "children": [1, 3, 4]}, {"name": "Shoulder", "children": [2]},
        {"name": "Elbow", "translation": [1, 0, 0]}, {"name": "Arm", "mesh": 0, "skin": 0, "translation": [5, 5, 5]},
        {"name": "Triangle", "mesh": 1, "translation": [0, 3, 0]}]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // 0°, 90° as the quaternion of the longer arc, 90°.
    let turns = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half, 0.0, 0.0, half, half];
    let bend = glb.animate("Bend", 2, "rotation", "LINEAR", (&[0.0, 1.0, 2.0], &turns));
    let moves = [0.0, 3.0, 0.0, 1.0, 3.0, 0.0, 2.0, 3.0, 0.0];
    glb.animate("Step", 4, "translation", "STEP", (&[0.5, 1.0, 2.0], &moves));
    let spline = [[0.0; 3], [0.0, 0.0, 0.0], [1.0, 0.0, -2.0], [0.5, 4.0, 0.0], [3.0, 1.0, 0.0], [0.0; 3]];
    glb.animate("Spline", 0, "translation", "CUBICSPLINE", (&[1.0, 3.0], spline.as_flattened()));
    glb.animate("Blend", 3, "weights", "LINEAR", (&[0.0, 1.0, 4.0], &[0.0, 0.0, 1.0, 0.5, 1.0, 0.5]));
    (glb, Parts { joints, weights, inverse, sparse, bend })
}

/// Returns the GLB file with one text replaced in its JSON.
#[cfg(feature = "textures")]
pub fn edited(file: &[u8], from: &str, to: &str) -> Vec<u8> {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let json = std::str::from_utf8(&file[20..20 + length]).unwrap();
    assert!(json.contains(from), "{from}");
    pack(json.replace(from, to).trim_end().as_bytes().to_vec(), file[28 + length..].to_vec())
}

/// Returns the GLB file with its JSON changed.
pub fn changed(file: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let mut root = serde_json::from_slice(&file[20..20 + length]).unwrap();
    change(&mut root);
    pack(root.to_string().into_bytes(), file[28 + length..].to_vec())
}

/// Returns a GLB file with these two chunks.
pub fn pack(mut json: Vec<u8>, mut bin: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let total = 12 + 8 + json.len() + 8 + bin.len();
    let mut out = b"glTF".to_vec();
    for v in [2, total as u32, json.len() as u32, 0x4E4F_534A] {
        out.extend(v.to_le_bytes());
    }
    out.extend(&json);
    for v in [bin.len() as u32, 0x004E_4942] {
        out.extend(v.to_le_bytes());
    }
    out.extend(&bin);
    out
}
