//! Cards as GLB (binary glTF 2.0), with the body that they grow on.

use super::{CardLevel, CardMesh, CardTextures, Cards};
use crate::{
    Error, Result, Rig, TriMesh,
    formats::gltf::{File, INT, SHORT},
    rig::{Bind, INFLUENCES},
};
use glam::{Mat4, Vec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use serde_json::{Value, json};

/// How a material draws partial coverage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CardAlpha {
    /// An opaque core and a blended fringe: no gaps, soft edges, and two draws.
    #[default]
    Core,
    /// Opaque where the coverage is at least a half: needs no order, and edges are hard.
    Mask,
    /// Blended: soft, and right only in the order of the file.
    Blend,
}

/// Look of the written cards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardLook {
    /// Color of the hair, linear; unused for strands that have colors of their own.
    pub color: Vec3,
    /// Drawing of partial coverage.
    pub alpha: CardAlpha,
}

/// Coverage from which the core is opaque.
const CORE: f32 = 0.6;
/// Strength of the anisotropy.
const ANISOTROPY: f32 = 0.8;
/// Share of the light from all around in vertex colors.
const SHADE: f32 = 0.5;
/// Rows of the screen for which the sizes of levels are given as coverage.
const SCREEN: f32 = 720.0;

impl Cards {
    /// Encodes all levels, and the body with its rig. The first level is in the scene; the others are its `MSFT_lod` levels. Each
    /// card follows the joints of the body's vertex nearest to its root.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a rig of another mesh, and for a file of more than 4 GB.
    pub fn glb(&self, body: Option<(&TriMesh, Option<&Rig>)>, look: &CardLook) -> Result<Vec<u8>> {
        let mut file = File::new();
        let mut skin = None;
        if let Some((mesh, rig)) = body {
            file.body(mesh, rig)?;
            skin = rig.map(|rig| CardSkin { rig, mesh, palette: rig.rest_pose().palette });
        } else {
            file.root["scenes"] = json!([{"nodes": []}]);
        }
        let materials = self.materials(&mut file, look)?;
        let nodes: Vec<usize> =
            self.levels.iter().map(|level| put_level(&mut file, level, skin.as_ref(), &materials)).collect();
        if let Some(list) = file.root["scenes"][0]["nodes"].as_array_mut() {
            list.push(json!(nodes[0]));
        }
        if nodes.len() > 1 {
            file.root["nodes"][nodes[0]]["extensions"] = json!({"MSFT_lod": {"ids": nodes[1..]}});
            // Coverage of the screen down to which each level is used.
            let sizes = self.levels[1..].iter().map(|level| (level.accuracy.switch / SCREEN).powi(2));
            let coverage: Vec<f32> = sizes.chain([0.0]).collect();
            file.root["nodes"][nodes[0]]["extras"] = json!({"MSFT_screencoverage": coverage});
        }
        let mut used = vec!["KHR_materials_anisotropy"];
        if nodes.len() > 1 {
            used.push("MSFT_lod");
        }
        file.root["extensionsUsed"] = json!(used);
        file.finish()
    }

    /// Writes textures and materials.
    fn materials(&self, file: &mut File, look: &CardLook) -> Result<Vec<Material>> {
        let textures = &self.textures;
        file.push("samplers", json!({"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}));
        let mut texture = |name: &str, bytes: Vec<u8>| {
            let view = file.view(&bytes);
            let image =
                file.push("images", json!({"name": name, "mimeType": "image/png", "bufferView": view}));
            json!({"index": file.push("textures", json!({"source": image, "sampler": 0}))})
        };
        let color = texture("color", textures.color_png()?);
        let anisotropy = texture("anisotropy", textures.anisotropy_png()?);
        let surface = texture("surface", textures.surface_png()?);
        let tint = if textures.has_colors { Vec3::ONE } else { look.color };
        let material = |name: &str, mode: Value| {
            let mut item = json!({
                "name": name,
                "doubleSided": true,
                "pbrMetallicRoughness": {
                    "baseColorFactor": tint.extend(1.0).to_array(),
                    "baseColorTexture": color,
                    "metallicFactor": 0.0,
                    "metallicRoughnessTexture": surface,
                },
                "occlusionTexture": surface,
                "extensions": {"KHR_materials_anisotropy": {
                    "anisotropyStrength": ANISOTROPY,
                    "anisotropyTexture": anisotropy,
                }},
            });
            if let (Some(item), Some(mode)) = (item.as_object_mut(), mode.as_object()) {
                item.extend(mode.clone());
            }
            item
        };
        let core = json!({"alphaMode": "MASK", "alphaCutoff": CORE});
        let mask = json!({"alphaMode": "MASK", "alphaCutoff": 0.5});
        let blend = json!({"alphaMode": "BLEND"});
        let mut all = match look.alpha {
            CardAlpha::Core => vec![material("hair core", core), material("hair fringe", blend)],
            CardAlpha::Mask => vec![material("hair", mask)],
            CardAlpha::Blend => vec![material("hair", blend)],
        };
        let of_cards = all.len();
        if self.levels.iter().any(|level| level.helmet) {
            all.push(material("hair helmet", json!({"alphaMode": "OPAQUE"})));
        }
        let put = |(i, item)| Material { index: file.push("materials", item), helmet: i >= of_cards };
        Ok(all.into_iter().enumerate().map(put).collect())
    }
}

/// A material of the file, for cards or for a helmet.
struct Material {
    index: usize,
    helmet: bool,
}

/// The body whose joints cards follow.
struct CardSkin<'a> {
    rig: &'a Rig,
    mesh: &'a TriMesh,
    palette: Vec<Mat4>,
}

impl CardSkin<'_> {
    /// Returns the skinning of the body's vertex nearest to `p`, and the transform that it has at rest.
    fn at(&self, p: Vec3) -> (Bind, Mat4) {
        let far = |i: &usize| self.mesh.positions[*i].distance_squared(p);
        let nearest = (0..self.mesh.positions.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let bind = self.rig.vertices[nearest];
        let mut matrix = Mat4::ZERO;
        for (joint, weight) in bind.joints.iter().zip(bind.weights).filter(|(_, weight)| *weight > 0.0) {
            matrix += self.palette.get(*joint as usize).copied().unwrap_or_default() * weight;
        }
        (bind, matrix)
    }
}

/// Writes a level and returns its node.
fn put_level(
    file: &mut File,
    level: &CardLevel,
    skin: Option<&CardSkin<'_>>,
    materials: &[Material],
) -> usize {
    let mesh = &level.mesh;
    let name = format!("Hair_LOD{}", level.index);
    let mut item = json!({"name": name});
    let mut attributes = match skin {
        Some(skin) => {
            item["skin"] = json!(0);
            skinned(file, mesh, skin)
        }
        None => shaped(file, &mesh.positions, &mesh.normals, &mesh.tangents),
    };
    let uvs = file.floats("VEC2", 2, mesh.uvs.iter().flat_map(|uv| uv.to_array()));
    let brightest = mesh.light.iter().copied().fold(1e-3, f32::max);
    let shade = |light: &f32| 1.0 - SHADE * (1.0 - light / brightest);
    let colors = file.floats("VEC3", 3, mesh.light.iter().flat_map(|light| [shade(light); 3]));
    attributes["TEXCOORD_0"] = json!(uvs);
    attributes["COLOR_0"] = json!(colors);
    let indices = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
    let indices = file.accessor(INT, "SCALAR", 3 * mesh.triangles.len(), indices);
    let primitives: Vec<Value> = materials
        .iter()
        .filter(|material| material.helmet == level.helmet)
        .map(|material| json!({"attributes": attributes, "indices": indices, "material": material.index}))
        .collect();
    item["mesh"] = json!(file.push("meshes", json!({"name": name, "primitives": primitives})));
    file.push("nodes", item)
}

/// Writes positions, normals and tangents.
fn shaped(file: &mut File, positions: &[Vec3], normals: &[Vec3], tangents: &[Vec3]) -> Value {
    let position = file.places(positions);
    let normal = file.floats("VEC3", 3, normals.iter().flat_map(|n| n.to_array()));
    // The bitangent, normal × tangent × w, runs against V, from tip to root.
    let tangent = file.floats("VEC4", 4, tangents.iter().flat_map(|t| t.extend(1.0).to_array()));
    json!({"POSITION": position, "NORMAL": normal, "TANGENT": tangent})
}

/// Writes positions, normals, tangents, joints and weights: at rest, joints move all to where `mesh` has them.
fn skinned(file: &mut File, mesh: &CardMesh, skin: &CardSkin<'_>) -> Value {
    let count = mesh.positions.len();
    let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
    let mut binds = Vec::with_capacity(count);
    let same = |i: &usize, j: &usize| mesh.roots[*i] == mesh.roots[*j];
    for stretch in (0..count).collect::<Vec<_>>().chunk_by(same) {
        let (bind, matrix) = skin.at(mesh.roots[stretch[0]]);
        let back = matrix.inverse();
        for i in stretch {
            positions.push(back.transform_point3(mesh.positions[*i]));
            normals.push(back.transform_vector3(mesh.normals[*i]).normalize_or(Vec3::Y));
            tangents.push(back.transform_vector3(mesh.tangents[*i]).normalize_or(Vec3::X));
            binds.push(bind);
        }
    }
    let mut attributes = shaped(file, &positions, &normals, &tangents);
    for set in 0..INFLUENCES / 4 {
        let range = 4 * set..4 * set + 4;
        if set > 0 && binds.iter().all(|bind| bind.weights[range.clone()].iter().all(|weight| *weight == 0.0))
        {
            break;
        }
        let joint = |(joint, weight): (&u16, &f32)| if *weight > 0.0 { *joint } else { 0 };
        let joints = binds
            .iter()
            .flat_map(|bind| bind.joints[range.clone()].iter().zip(&bind.weights[range.clone()]).map(joint))
            .flat_map(u16::to_le_bytes)
            .collect();
        let joints = file.accessor(SHORT, "VEC4", count, joints);
        let weights =
            file.floats("VEC4", 4, binds.iter().flat_map(|bind| bind.weights[range.clone()].to_vec()));
        attributes[format!("JOINTS_{set}")] = json!(joints);
        attributes[format!("WEIGHTS_{set}")] = json!(weights);
    }
    attributes
}

impl CardTextures {
    /// Returns [`color`](Self::color) as PNG.
    ///
    /// # Errors
    /// [`Error::Unusable`] if the image cannot be encoded.
    pub fn color_png(&self) -> Result<Vec<u8>> {
        self.png(self.color.as_flattened(), ExtendedColorType::Rgba8)
    }

    /// Returns [`anisotropy`](Self::anisotropy) as PNG.
    ///
    /// # Errors
    /// As [`color_png`](Self::color_png).
    pub fn anisotropy_png(&self) -> Result<Vec<u8>> {
        self.png(self.anisotropy.as_flattened(), ExtendedColorType::Rgb8)
    }

    /// Returns [`surface`](Self::surface) as PNG.
    ///
    /// # Errors
    /// As [`color_png`](Self::color_png).
    pub fn surface_png(&self) -> Result<Vec<u8>> {
        self.png(self.surface.as_flattened(), ExtendedColorType::Rgb8)
    }

    /// Returns [`data`](Self::data) as PNG.
    ///
    /// # Errors
    /// As [`color_png`](Self::color_png).
    pub fn data_png(&self) -> Result<Vec<u8>> {
        self.png(self.data.as_flattened(), ExtendedColorType::Rgba8)
    }

    fn png(&self, bytes: &[u8], kind: ExtendedColorType) -> Result<Vec<u8>> {
        let mut file = Vec::new();
        let encoded = PngEncoder::new(&mut file).write_image(bytes, self.size, self.size, kind);
        encoded.map_err(|error| Error::Unusable(format!("a texture cannot be encoded: {error}")))?;
        Ok(file)
    }
}
