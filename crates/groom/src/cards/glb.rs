//! Cards as GLB (binary glTF 2.0), with the body that they grow on.

use super::{CardLevel, CardTextures, Cards, ChainMotion};
use crate::{
    Error, Result, Rig, TriMesh,
    formats::{
        faces::PLAIN,
        gltf::{File, INT},
    },
    near::PointTree,
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
#[derive(Clone, Debug, PartialEq)]
pub struct CardLook {
    /// Color of the hair, linear; unused for strands that have colors of their own.
    pub color: Vec3,
    /// Drawing of partial coverage.
    pub alpha: CardAlpha,
    /// Motion of the chains in animations of the rig.
    pub motions: Vec<ChainMotion>,
}

/// Coverage from which the core is opaque.
const CORE: f32 = 0.6;
/// Strength of the anisotropy.
const ANISOTROPY: f32 = 0.8;
/// Strength of the highlight: with it, black cards are as bright as black strands under a light from the front.
const SPECULAR: f32 = 0.65;
/// Roughness of the head.
const SKIN: f32 = 0.6;
/// Share of the light from all around in vertex colors.
const SHADE: f32 = 0.5;
/// Rows of the screen for which the sizes of levels are given as coverage.
const SCREEN: f32 = 720.0;

impl Cards {
    /// Encodes all levels, and the body with its rig. The first level is in the scene; the others are its `MSFT_lod`
    /// levels. Cards follow their chains of bones, which are nodes of the body's skeleton; without chains, each follows
    /// the joints of the body's vertex nearest to its root.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a head with another number of vertices than in the bake, for a rig of another mesh, and
    /// for a file of more than 4 GB.
    pub fn glb(&self, body: Option<(&TriMesh, Option<&Rig>)>, look: &CardLook) -> Result<Vec<u8>> {
        let mut file = File::new();
        file.root["scenes"] = json!([{"nodes": []}]);
        let mut skin = None;
        let tint = if self.textures.has_colors { Vec3::ONE } else { look.color };
        let (head, rig) = body.map_or((None, None), |(head, rig)| (Some(head), rig));
        let vertices = PointTree::new(head.map_or(&[][..], |head| &head.positions));
        if let Some(mesh) = head {
            let mesh = self.painted(mesh, tint)?;
            if self.chains.is_empty() {
                file.body(&mesh, rig)?;
                skin = rig.map(|rig| CardSkin::Body { rig, vertices, palette: rig.rest_pose().palette });
            } else {
                let still = Rig::still(&mesh);
                let chain_rig = self.chains.on(rig.unwrap_or(&still), &vertices, &look.motions);
                file.body(&mesh, Some(&chain_rig.rig))?;
                skin = Some(CardSkin::chains(&mut file, &chain_rig.bones));
            }
        } else if !self.chains.is_empty() {
            let chain_rig = self.chains.on(&Rig::default(), &vertices, &[]);
            file.skeleton(&chain_rig.rig);
            skin = Some(CardSkin::chains(&mut file, &chain_rig.bones));
        }
        let materials = self.materials(&mut file, tint, look.alpha)?;
        if body.is_some() {
            let skin = json!({"name": "skin", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": SKIN}});
            file.root["meshes"][0]["primitives"][0]["material"] = json!(file.push("materials", skin));
        }
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
        let mut used = vec!["KHR_materials_anisotropy", "KHR_materials_specular"];
        if nodes.len() > 1 {
            used.push("MSFT_lod");
        }
        file.root["extensionsUsed"] = json!(used);
        file.finish()
    }

    /// Returns the head with the color of hair where hair grows.
    fn painted(&self, head: &TriMesh, tint: Vec3) -> Result<TriMesh> {
        let count = head.positions.len();
        if self.scalp.cover.len() != count {
            return Err(Error::Unusable("the cards were baked for another head".into()));
        }
        let mut head = head.clone();
        head.colors.resize(count, PLAIN);
        for ((skin, cover), hair) in head.colors.iter_mut().zip(&self.scalp.cover).zip(&self.scalp.colors) {
            *skin = skin.lerp(*hair * tint, *cover);
        }
        Ok(head)
    }

    /// Writes textures and materials.
    fn materials(&self, file: &mut File, tint: Vec3, alpha: CardAlpha) -> Result<Vec<Material>> {
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
                "extensions": {
                    "KHR_materials_anisotropy": {
                        "anisotropyStrength": ANISOTROPY,
                        "anisotropyTexture": anisotropy,
                    },
                    "KHR_materials_specular": {"specularFactor": SPECULAR},
                },
            });
            if let (Some(item), Some(mode)) = (item.as_object_mut(), mode.as_object()) {
                item.extend(mode.clone());
            }
            item
        };
        let core = json!({"alphaMode": "MASK", "alphaCutoff": CORE});
        let mask = json!({"alphaMode": "MASK", "alphaCutoff": 0.5});
        let blend = json!({"alphaMode": "BLEND"});
        let mut all = match alpha {
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

/// Joints or bones that move cards.
enum CardSkin<'a> {
    /// The joints of the body.
    Body { rig: &'a Rig, vertices: PointTree<'a>, palette: Vec<Mat4> },
    /// Chains of bones, the file's skin of this index.
    Chains(usize),
}

impl CardSkin<'_> {
    /// Writes the skin of chains.
    fn chains(file: &mut File, bones: &[(usize, Mat4)]) -> Self {
        let binds = file.floats("MAT4", 16, bones.iter().flat_map(|(_, back)| back.to_cols_array()));
        let joints: Vec<usize> = bones.iter().map(|(node, _)| *node).collect();
        Self::Chains(file.push("skins", json!({"joints": joints, "inverseBindMatrices": binds})))
    }

    /// Index of the file's skin.
    fn index(&self) -> usize {
        match self {
            Self::Body { .. } => 0,
            Self::Chains(index) => *index,
        }
    }

    /// Writes positions, normals, tangents, joints and weights of a level.
    fn put(&self, file: &mut File, level: &CardLevel) -> Value {
        let mesh = &level.mesh;
        let Self::Body { rig, vertices, palette } = self else {
            let mut attributes = shaped(file, &mesh.positions, &mesh.normals, &mesh.tangents);
            let joints: Vec<_> = level.binds.iter().flat_map(|bind| bind.bones).collect();
            let weights: Vec<_> = level.binds.iter().flat_map(|bind| bind.weights).collect();
            file.weights(&mut attributes, 0, &joints, &weights);
            return attributes;
        };
        // At rest, joints move all to where `mesh` has them.
        let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
        let mut binds = Vec::new();
        let all: Vec<usize> = (0..mesh.positions.len()).collect();
        for stretch in all.chunk_by(|i, j| mesh.roots[*i] == mesh.roots[*j]) {
            let bind = rig.vertices[vertices.closest(mesh.roots[stretch[0]]).unwrap_or(0)];
            let back = transform(&bind, palette).inverse();
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
            let joints: Vec<_> = binds.iter().flat_map(|bind| bind.joints[range.clone()].to_vec()).collect();
            let weights: Vec<_> =
                binds.iter().flat_map(|bind| bind.weights[range.clone()].to_vec()).collect();
            if set > 0 && weights.iter().all(|weight| *weight == 0.0) {
                break;
            }
            file.weights(&mut attributes, set, &joints, &weights);
        }
        attributes
    }
}

/// Returns the transform that `bind` has in a pose.
fn transform(bind: &Bind, palette: &[Mat4]) -> Mat4 {
    let mut matrix = Mat4::ZERO;
    for (joint, weight) in bind.joints.iter().zip(bind.weights).filter(|(_, weight)| *weight > 0.0) {
        matrix += palette.get(*joint as usize).copied().unwrap_or_default() * weight;
    }
    matrix
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
            item["skin"] = json!(skin.index());
            skin.put(file, level)
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
    let position = file.position_accessor(positions);
    let normal = file.floats("VEC3", 3, normals.iter().flat_map(|n| n.to_array()));
    // The bitangent, normal × tangent × w, runs against V, from tip to root.
    let tangent = file.floats("VEC4", 4, tangents.iter().flat_map(|t| t.extend(1.0).to_array()));
    json!({"POSITION": position, "NORMAL": normal, "TANGENT": tangent})
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
