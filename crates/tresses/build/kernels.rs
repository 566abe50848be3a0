//! Generates a Rust struct for the `@group(0)` of each compute shader: one named field per binding. A missing or extra
//! buffer, or one whose elements have another type, does not compile.
//!
//! Bindings that a shader declares itself are fields of its struct. Bindings that it imports from a module are a nested
//! struct, named after that module, so that shaders can share it. A module that declares a single binding has no struct.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
};

/// A binding that a file declares.
#[derive(Clone, Debug, PartialEq)]
struct Declaration {
    /// Module that declares it, for example `simulate::strand`.
    module: String,
    name: String,
}

/// A binding of `@group(0)` in a linked shader.
#[derive(Clone, Debug)]
struct Used {
    declaration: Declaration,
    /// `wgpu::BindingType`.
    binding: String,
    /// Rust type of the field.
    rust: String,
}

/// Tables of `src/constants.rs` that shaders cannot express.
pub struct Tables<'a> {
    /// Structs of shaders that share their bind groups, and the modules of those shaders.
    pub families: &'a [(&'a str, &'a [&'a str])],
    /// Names and struct types of bindings with a dynamic offset.
    pub dynamic: &'a [&'a str],
    /// WGSL structs that typed buffers hold, and their Rust types.
    pub elements: &'a [(&'a str, &'a str)],
}

/// Returns the Rust source. `files` are the WESL modules, `linked` the linked compute shaders, each as (module, text).
pub fn generate(files: &[(String, String)], linked: &[(String, String)], tables: &Tables<'_>) -> String {
    let declared = declarations(files);
    let mut kernels: BTreeMap<String, (Vec<&str>, BTreeMap<u32, Used>)> = BTreeMap::new();
    for (module, text) in linked.iter().filter(|(_, text)| text.contains("@compute")) {
        let family = tables.families.iter().find(|(_, modules)| modules.contains(&&**module));
        let name = family.map_or_else(|| path_of(module), |(name, _)| (*name).to_owned());
        let (modules, bindings) = kernels.entry(name).or_default();
        modules.push(module);
        for (index, used) in bindings_of(module, text, &declared, tables) {
            let known = bindings.entry(index).or_insert_with(|| used.clone());
            let is_same = known.declaration.name == used.declaration.name && known.rust == used.rust;
            assert!(is_same, "{module}: binding {index} is {used:?}, in other shaders {known:?}");
            // A family writes what one of its shaders writes.
            if used.binding.contains("read_only: false") {
                known.binding = used.binding;
            }
        }
    }
    let count = |module: &str| declared.values().filter(|other| other.module == module).count();
    let mut nested: BTreeMap<String, BTreeMap<&str, String>> = BTreeMap::new();
    let mut scopes: BTreeMap<String, String> = BTreeMap::new();
    for (path, (modules, bindings)) in &kernels {
        let (mut fields, mut layout, mut resources) = (BTreeMap::new(), String::new(), String::new());
        for (index, Used { declaration: Declaration { module, name }, binding, rust }) in bindings {
            let _ = write!(layout, "({index}, wgpu::BindingType::{binding}), ");
            if modules.contains(&&**module) || count(module) == 1 {
                let _ = write!(resources, "self.{name}.resource(), ");
                fields.insert(&**name, rust.clone());
            } else {
                let field = module.rsplit("::").next().unwrap_or(module);
                let _ = write!(resources, "self.{field}.{name}.resource(), ");
                fields.insert(field, format!("kernels::{}<'a>", path_of(module)));
                nested.entry(path_of(module)).or_default().insert(name, rust.clone());
            }
        }
        let (scope, title) = split(path);
        let text = scopes.entry(scope.to_owned()).or_default();
        *text += &structure(&format!("Bindings of the kernels {modules:?}."), title, &fields);
        *text += &format!(
            "impl crate::gpu::Bindings for {title}<'_> {{\n\
             const MODULES: &'static [&'static str] = &{modules:?};\n\
             const LAYOUT: &'static [(u32, wgpu::BindingType)] = &[{layout}];\n\
             fn resources(&self) -> Vec<wgpu::BindingResource<'_>> {{ vec![{resources}] }}\n}}\n"
        );
    }
    for (path, fields) in &nested {
        let (scope, title) = split(path);
        *scopes.entry(scope.to_owned()).or_default() +=
            &structure("Bindings that several shaders import.", title, fields);
    }
    module(&scopes, "")
}

/// Returns the declaration of a struct.
fn structure(doc: &str, title: &str, fields: &BTreeMap<&str, String>) -> String {
    let fields = fields.iter().map(|(name, rust)| format!("    pub {name}: {rust},\n")).collect::<String>();
    format!("/// {doc}\n#[derive(Clone, Copy, Debug)]\npub(crate) struct {title}<'a> {{\n{fields}}}\n")
}

/// Returns the module of a path and the name in it.
fn split(path: &str) -> (&str, &str) {
    path.rsplit_once("::").unwrap_or(("", path))
}

/// Returns the content of the Rust module `scope` and the modules in it.
fn module(scopes: &BTreeMap<String, String>, scope: &str) -> String {
    let prefix = if scope.is_empty() { String::new() } else { format!("{scope}::") };
    let own = scopes.get(scope).map_or(String::new(), |text| {
        format!("#[allow(unused_imports)]\nuse crate::{{gpu::Resource as _, shaders::kernels}};\n{text}")
    });
    let inner = scopes.keys().filter_map(|path| path.strip_prefix(&prefix)?.split("::").next());
    let inner: BTreeSet<_> = inner.filter(|name| !name.is_empty()).collect();
    inner.into_iter().fold(own, |rust, name| {
        rust + &format!("pub(crate) mod {name} {{\n{}}}\n", module(scopes, &format!("{prefix}{name}")))
    })
}

/// Returns the path of the struct of a module: `simulate::grab::pick` has `simulate::grab::Pick`.
fn path_of(module: &str) -> String {
    let (scope, name) = split(module);
    let title = name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect::<String>();
    format!("{scope}::{title}")
}

/// Returns the bindings that each file declares, by the names that the linker gives them in other shaders.
fn declarations(files: &[(String, String)]) -> BTreeMap<String, Declaration> {
    let mut declared = BTreeMap::new();
    for (module, text) in files {
        for (group, _, _, name, _) in variables(text) {
            if group == 0 {
                let path = format!("package::{module}::{name}");
                let declaration = Declaration { module: module.clone(), name: name.to_owned() };
                declared.insert(path.split("::").map(mangled).collect::<Vec<_>>().join("_"), declaration);
            }
        }
    }
    declared
}

/// Returns a part of a path as the linker writes it.
fn mangled(part: &str) -> String {
    match part.matches('_').count() {
        0 => part.to_owned(),
        count => format!("_{count}{part}"),
    }
}

/// Returns the bindings of `@group(0)` of a linked shader, by number.
fn bindings_of(
    module: &str,
    text: &str,
    declared: &BTreeMap<String, Declaration>,
    tables: &Tables<'_>,
) -> BTreeMap<u32, Used> {
    let used = |(_, index, space, name, ty): (u32, u32, &str, &str, &str)| {
        let own = || Declaration { module: module.to_owned(), name: name.to_owned() };
        let declaration = declared.get(name).cloned().unwrap_or_else(own);
        let element = ty.trim_start_matches("array<").split(['<', ',', '>']).next().unwrap_or(ty);
        let is_dynamic = [element.trim_start_matches("structs_"), &declaration.name]
            .iter()
            .any(|name| tables.dynamic.contains(name));
        let buffer = |ty| {
            format!(
                "Buffer {{ ty: wgpu::BufferBindingType::{ty}, has_dynamic_offset: {is_dynamic}, \
                 min_binding_size: None }}"
            )
        };
        let binding = match space {
            "<uniform>" => buffer("Uniform"),
            "<storage, read>" => buffer("Storage { read_only: true }"),
            "<storage, read_write>" => buffer("Storage { read_only: false }"),
            _ => resource_of(text, name, ty),
        };
        let rust = match space {
            "" if ty.starts_with("sampler") => "&'a wgpu::Sampler".to_owned(),
            "" => "&'a wgpu::TextureView".to_owned(),
            _ => format!("crate::gpu::BufferBinding<'a, {}>", element_of(ty, tables)),
        };
        (index, Used { declaration, binding, rust })
    };
    variables(text).filter(|(group, ..)| *group == 0).map(used).collect()
}

/// Returns the Rust type of the elements of a buffer.
fn element_of(ty: &str, tables: &Tables<'_>) -> String {
    let element = ty.strip_prefix("array<").and_then(|ty| ty.strip_suffix('>')).unwrap_or(ty);
    // The length of an array of fixed size.
    let element = element.rsplit_once(", ").map_or(element, |(element, _)| element);
    let element = element.strip_prefix("atomic<").and_then(|ty| ty.strip_suffix('>')).unwrap_or(element);
    let of = element.trim_start_matches("structs_");
    if let Some((_, rust)) = tables.elements.iter().find(|(wgsl, _)| *wgsl == of) {
        return format!("crate::{rust}");
    }
    match of.strip_prefix("vec").and_then(|of| of.strip_suffix('>')).and_then(|of| of.split_once('<')) {
        Some((count, scalar)) => format!("[{scalar}; {count}]"),
        None if ["f32", "u32", "i32"].contains(&of) => of.to_owned(),
        None => "crate::gpu::Opaque".to_owned(),
    }
}

/// Returns the `wgpu::BindingType` of a texture or sampler. A texture need only be filterable if the shader samples it.
fn resource_of(text: &str, name: &str, ty: &str) -> String {
    let takes_texture = |line: &str| line.starts_with("fn ") && line.contains(": texture_");
    assert!(!text.lines().any(takes_texture), "{name}: a function takes a texture, and may sample it");
    let mut calls = text.split("textureSample").skip(1).filter_map(|call| call.split_once('('));
    let is_filtered = calls.any(|(_, arguments)| arguments.split(',').next() == Some(name));
    let (kind, of) = ty.split_once('<').unwrap_or((ty, ""));
    let dimension = match kind.rsplit_once('_').map(|(_, last)| last) {
        Some("array") => "D2Array",
        Some("cube") => "Cube",
        Some("3d") => "D3",
        _ => "D2",
    };
    let multisampled = kind.contains("multisampled");
    let texture = |sample| {
        format!(
            "Texture {{ sample_type: wgpu::TextureSampleType::{sample}, multisampled: {multisampled}, \
             view_dimension: wgpu::TextureViewDimension::{dimension} }}"
        )
    };
    match of.trim_end_matches('>').trim_end_matches(", write") {
        "f32" if is_filtered => texture("Float { filterable: true }"),
        "f32" => texture("Float { filterable: false }"),
        "u32" => texture("Uint"),
        "" if kind == "sampler" => "Sampler(wgpu::SamplerBindingType::Filtering)".into(),
        "" if kind == "sampler_comparison" => "Sampler(wgpu::SamplerBindingType::Comparison)".into(),
        "" if kind.starts_with("texture_depth") => texture("Depth"),
        texels => {
            let format = match texels {
                "rgba16float" => "Rgba16Float",
                "rgba32float" => "Rgba32Float",
                "r32uint" => "R32Uint",
                "rgba32uint" => "Rgba32Uint",
                _ => panic!("{name}: {ty} is not known"),
            };
            format!(
                "StorageTexture {{ access: wgpu::StorageTextureAccess::WriteOnly, format: \
                 wgpu::TextureFormat::{format}, view_dimension: wgpu::TextureViewDimension::{dimension} }}"
            )
        }
    }
}

/// Returns the bindings that a text declares: group, binding, address space, name, type.
fn variables(text: &str) -> impl Iterator<Item = (u32, u32, &str, &str, &str)> {
    text.split("@group(").skip(1).map(|text| {
        let declaration = text.split(';').next().unwrap_or(text);
        let number = |text: &str| text.split(')').next().and_then(|number| number.trim().parse().ok());
        let (_, binding) = declaration.split_once("@binding(").expect("a group has a binding");
        let (_, variable) = binding.split_once("var").expect("a binding is a variable");
        let (left, ty) = variable.split_once(':').expect("a binding has a type");
        let (space, name) = left.rsplit_once(' ').expect("a variable has a name");
        let numbers = (number(declaration), number(binding));
        let (Some(group), Some(binding)) = numbers else { panic!("not numbers: {declaration}") };
        (group, binding, space.trim(), name.trim(), ty.trim())
    })
}
