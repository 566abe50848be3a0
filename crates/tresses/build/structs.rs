//! Generates the WGSL of each struct that host and shaders share from its Rust definition. A shader writes
//! `import structs::CameraUniform;`.
//!
//! A struct is shared if it derives `Pod`. `Pod` forbids implicit padding, so a field's offset in Rust is the sum of
//! the sizes before it. WGSL rounds that sum up to the field's alignment. If the two offsets differ, generation fails
//! with an error. Vertex formats derive `NoUninit` instead, since no shader declares them.

use std::collections::BTreeMap;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

struct Struct {
    file: String,
    /// Names and types.
    fields: Vec<(String, Vec<TokenTree>)>,
}

/// A WGSL type with its alignment and size in bytes.
struct Type {
    wgsl: String,
    align: u32,
    size: u32,
    /// Size in Rust, bytes.
    packed: u32,
}

/// Returns the WGSL of all shared structs in `sources` (path and text of Rust files). `constants` are the named array
/// lengths. Errors name file, struct and field.
pub fn generate(sources: &[(String, String)], constants: &[(&str, u32)]) -> Result<String, String> {
    let mut structs = BTreeMap::new();
    for (file, text) in sources {
        let tokens = text.parse().map_err(|error| format!("{file}: {error}"))?;
        collect(tokens, file, &mut structs)?;
    }
    let generator = Generator { structs, constants };
    let mut wgsl = String::new();
    for name in generator.structs.keys() {
        wgsl += &generator.layout(name)?.1;
    }
    Ok(wgsl)
}

/// Adds the shared structs of a file or module.
fn collect(tokens: TokenStream, file: &str, structs: &mut BTreeMap<String, Struct>) -> Result<(), String> {
    let tokens: Vec<_> = tokens.into_iter().collect();
    let mut is_shared = false;
    for (i, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(attribute) if attribute.delimiter() == Delimiter::Bracket => {
                is_shared |= derives_pod(attribute);
            }
            TokenTree::Group(group) => {
                collect(group.stream(), file, structs)?;
                is_shared &= group.delimiter() != Delimiter::Brace;
            }
            TokenTree::Ident(word) if is_shared && word == "struct" => {
                let name = tokens[i + 1].to_string();
                let fields = match &tokens[i + 2] {
                    TokenTree::Group(body) if body.delimiter() == Delimiter::Brace => fields(body.stream()),
                    _ => {
                        return Err(format!(
                            "{file}: {name} derives Pod but has no named fields, or is generic"
                        ));
                    }
                };
                let found = Struct { file: file.to_owned(), fields };
                if let Some(other) = structs.insert(name.clone(), found) {
                    return Err(format!(
                        "{file}: {name} is also a shared struct in {}; rename one",
                        other.file
                    ));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn derives_pod(attribute: &Group) -> bool {
    let tokens: Vec<_> = attribute.stream().into_iter().collect();
    let [TokenTree::Ident(derive), TokenTree::Group(traits)] = &tokens[..] else { return false };
    derive == "derive" && traits.stream().into_iter().any(|token| token.to_string() == "Pod")
}

fn fields(body: TokenStream) -> Vec<(String, Vec<TokenTree>)> {
    let is = |token: &TokenTree, c| matches!(token, TokenTree::Punct(punct) if punct.as_char() == c);
    let tokens: Vec<_> = body.into_iter().collect();
    let fields = tokens.split(|token| is(token, ','));
    // Attributes and visibility contain no colon outside groups.
    let field = |field: &[TokenTree]| {
        let colon = field.iter().position(|token| is(token, ':'))?;
        Some((field[colon - 1].to_string(), field[colon + 1..].to_vec()))
    };
    fields.filter_map(field).collect()
}

struct Generator<'a> {
    structs: BTreeMap<String, Struct>,
    constants: &'a [(&'a str, u32)],
}

impl Generator<'_> {
    /// Returns a struct's type and its WGSL declaration.
    fn layout(&self, name: &str) -> Result<(Type, String), String> {
        let Struct { file, fields } = &self.structs[name];
        let (mut align, mut size, mut packed) = (1, 0u32, 0);
        let mut wgsl = format!("public struct {name} {{\n");
        for (field, tokens) in fields {
            let ty = self.resolve(tokens).map_err(|what| format!("{file}: {name}.{field}: {what}"))?;
            if field.starts_with("_pad") {
                for word in 0..ty.packed / 4 {
                    wgsl += &format!("    {field}_{word}: u32,\n");
                }
                (size, packed) = (size + ty.packed, packed + ty.packed);
                continue;
            }
            let offset = size.next_multiple_of(ty.align);
            if offset != packed {
                return Err(format!(
                    "{file}: {name}.{field} is at byte {packed} in Rust but at byte {offset} in WGSL; move it or put \
                     padding before it"
                ));
            }
            wgsl += &format!("    {field}: {},\n", ty.wgsl);
            (align, size, packed) = (align.max(ty.align), offset + ty.size, packed + ty.packed);
        }
        size = size.next_multiple_of(align);
        if size != packed {
            return Err(format!(
                "{file}: {name} has {packed} bytes in Rust but {size} bytes in WGSL; put padding at its end"
            ));
        }
        Ok((Type { wgsl: name.to_owned(), align, size, packed }, wgsl + "}\n"))
    }

    fn resolve(&self, tokens: &[TokenTree]) -> Result<Type, String> {
        match tokens {
            [TokenTree::Group(array)] => self.array(array),
            [.., TokenTree::Ident(name)] => self.named(&name.to_string()),
            _ => Err("WGSL has no such type".to_owned()),
        }
    }

    fn named(&self, name: &str) -> Result<Type, String> {
        let scalar = |wgsl: &str| Type { wgsl: wgsl.to_owned(), align: 4, size: 4, packed: 4 };
        Ok(match name {
            "f32" | "u32" | "i32" => scalar(name),
            "Atomic" => scalar("atomic<u32>"),
            "Vec2" => vector("f32", 2),
            "Vec3" => vector("f32", 3),
            "Vec4" | "Quat" => vector("f32", 4),
            "UVec2" => vector("u32", 2),
            "UVec3" => vector("u32", 3),
            "UVec4" => vector("u32", 4),
            "IVec2" => vector("i32", 2),
            "IVec3" => vector("i32", 3),
            "IVec4" => vector("i32", 4),
            "Mat4" => Type { wgsl: "mat4x4<f32>".to_owned(), align: 16, size: 64, packed: 64 },
            name if self.structs.contains_key(name) => self.layout(name)?.0,
            name => return Err(format!("{name} is neither a type of WGSL nor a shared struct")),
        })
    }

    /// Converts an array. Two to four scalars become a vector.
    fn array(&self, array: &Group) -> Result<Type, String> {
        let tokens: Vec<_> = array.stream().into_iter().collect();
        let [element @ .., length] = &*tokens.split(|token| token.to_string() == ";").collect::<Vec<_>>()
        else {
            return Err("WGSL has no such type".to_owned());
        };
        let of = self.resolve(&element.concat())?;
        let length = match length {
            [length] => length.to_string(),
            [length, cast, _] if cast.to_string() == "as" => length.to_string(),
            _ => return Err("the length of an array is a number or a constant".to_owned()),
        };
        let known = self.constants.iter().find(|(name, _)| *name == length).map(|(_, value)| *value);
        let count =
            known.or_else(|| length.parse().ok()).ok_or(format!("{length} is not in constants::SHARED"))?;
        if matches!(&*of.wgsl, "f32" | "u32" | "i32") && (2..=4).contains(&count) {
            return Ok(vector(&of.wgsl, count));
        }
        let wgsl = format!("array<{}, {count}>", of.wgsl);
        let size = count * of.size.next_multiple_of(of.align);
        Ok(Type { wgsl, align: of.align, size, packed: count * of.packed })
    }
}

fn vector(scalar: &str, count: u32) -> Type {
    let size = 4 * count;
    Type { wgsl: format!("vec{count}<{scalar}>"), align: size.next_power_of_two(), size, packed: size }
}
