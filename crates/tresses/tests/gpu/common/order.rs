//! Shaders whose workgroups have other numbers, and shaders whose workgroup memory starts with NaN. A driver that runs
//! workgroups in order, on zeroed memory, hides kernels that depend on either.
//!
//! The functions change the text of linked shaders, which has one line per attribute list and per signature. They panic
//! at any other form.

use tresses::Context;

/// Changes of the text of a shader.
type Rewrite = fn(&str) -> String;

/// The last workgroup of each dimension comes first.
const REVERSED: &str = "groups - 1u - id";

/// A permutation of the workgroups of each dimension. The prime is greater than any number of workgroups, and products
/// of its remainder do not overflow.
const PERMUTED: &str = "(id * (211747u % groups) + groups / 2u) % groups";

/// Pattern of memory that a kernel has not written: NaN as a float, and a large integer.
const NAN: &str = "0x7fff7fffu";

/// Environment variable with the name of one of [`VARIANTS`]: all tests of the GPU run with it.
pub const VARIABLE: &str = "TRESSES_WORKGROUPS";

/// Names of contexts that must not change any result, and the changes of their shaders. In the last one workgroups are
/// permuted too, and new buffers and textures do not start at zero either.
const VARIANTS: [(&str, Rewrite); 3] = [
    ("reversed", |wgsl| rewrite(wgsl, Some(REVERSED), false)),
    ("permuted", |wgsl| rewrite(wgsl, Some(PERMUTED), false)),
    ("filled", |wgsl| rewrite(wgsl, Some(PERMUTED), true)),
];

/// Returns `context` with each of the changes, the one with the most changes first.
pub fn variants(context: &Context) -> impl Iterator<Item = (&'static str, Context)> {
    VARIANTS.into_iter().rev().map(|(name, rewrite)| (name, with(context.clone(), name, rewrite)))
}

/// Returns the context that the environment selects, `context` itself without a selection.
pub fn selected(context: Context) -> Context {
    let Ok(selected) = std::env::var(VARIABLE) else { return context };
    let found = VARIANTS.into_iter().find(|(name, _)| *name == selected);
    let (name, rewrite) = found.unwrap_or_else(|| panic!("{VARIABLE}={selected} is not one of {VARIANTS:?}"));
    with(context, name, rewrite)
}

fn with(context: Context, name: &str, rewrite: Rewrite) -> Context {
    let context = context.with_rewritten_shaders(rewrite);
    if name == "filled" { context.with_filled_memory() } else { context }
}

/// Returns the shader `wgsl` with the changes of the variant `name`.
pub fn rewritten(name: &str, wgsl: &str) -> String {
    VARIANTS.into_iter().find(|(own, _)| *own == name).expect("a variant").1(wgsl)
}

/// Maps the workgroups of each compute entry point by an expression of `id` and `groups`, and fills workgroup memory.
fn rewrite(wgsl: &str, map: Option<&str>, fill: bool) -> String {
    if !wgsl.contains("@compute") {
        return wgsl.to_owned();
    }
    let memory: Vec<_> = wgsl.lines().filter_map(Memory::of).collect();
    assert_eq!(memory.len(), wgsl.matches("var<workgroup>").count(), "workgroup memory in another form");
    let memory = if fill { &memory[..] } else { &[] };
    let (mut text, mut lines, mut entries) = (String::new(), wgsl.lines(), 0);
    while let Some(line) = lines.next() {
        text += line;
        text += "\n";
        let Some(size) = line.strip_prefix("@compute @workgroup_size(") else { continue };
        let size: Vec<_> = size.strip_suffix(')').expect("a workgroup size").split(", ").collect();
        let entry = Entry::of(lines.next().expect("a signature"), &size);
        text += &entry.rewritten(map, memory);
        entries += 1;
    }
    assert_eq!(entries, wgsl.matches("@compute").count(), "entry points in another form");
    if let Some(map) = map {
        text += &format!("fn order_map(id: vec3<u32>, groups: vec3<u32>) -> vec3<u32> {{ return {map}; }}\n");
    }
    text
}

/// A variable in workgroup memory.
struct Memory<'a> {
    name: &'a str,
    /// Type of an element.
    element: &'a str,
    /// Number of elements of an array.
    count: Option<&'a str>,
}

impl<'a> Memory<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let (name, ty) = line.strip_prefix("var<workgroup> ")?.strip_suffix(';')?.split_once(": ")?;
        let Some(array) = ty.strip_prefix("array<") else {
            return Some(Self { name, element: ty, count: None });
        };
        let (element, count) = array.strip_suffix('>')?.rsplit_once(", ")?;
        Some(Self { name, element, count: Some(count) })
    }

    /// Returns the statement of the invocation `local` of `threads` that fills its part of the variable.
    fn filled(&self, local: &str, threads: &str) -> String {
        let Self { name, element, count } = self;
        let value = match *element {
            "u32" => "order_word".to_owned(),
            "i32" => "bitcast<i32>(order_word)".to_owned(),
            "f32" | "vec2<f32>" | "vec3<f32>" | "vec4<f32>" => format!("{element}(bitcast<f32>(order_word))"),
            "vec2<u32>" | "vec3<u32>" | "vec4<u32>" => format!("{element}(order_word)"),
            "atomic<u32>" => "order_word".to_owned(),
            other => panic!("workgroup memory of {other}"),
        };
        let store = |place: String| match *element {
            "atomic<u32>" => format!("atomicStore(&{place}, {value});"),
            _ => format!("{place} = {value};"),
        };
        match count {
            None => format!("if {local} == 0u {{ {} }}\n", store((*name).to_owned())),
            Some(count) => format!(
                "for (var order_i = {local}; order_i < {count}; order_i += {threads}) {{ {} }}\n",
                store(format!("{name}[order_i]"))
            ),
        }
    }
}

/// The signature of a compute entry point.
struct Entry<'a> {
    name: &'a str,
    /// Threads of a workgroup in each dimension.
    size: [&'a str; 3],
    /// Built-in values and the names of their parameters.
    inputs: Vec<(&'a str, &'a str)>,
}

impl<'a> Entry<'a> {
    fn of(line: &'a str, size: &[&'a str]) -> Self {
        let signature = line.strip_prefix("fn ").and_then(|line| line.strip_suffix(") {"));
        let (name, inputs) =
            signature.and_then(|line| line.split_once('(')).expect("a signature in one line");
        let input = |input: &'a str| {
            let (builtin, rest) = input.strip_prefix("@builtin(")?.split_once(") ")?;
            let (name, ty) = rest.split_once(": ")?;
            let is_known = match builtin {
                "workgroup_id" | "global_invocation_id" | "num_workgroups" => ty == "vec3<u32>",
                "local_invocation_index" => ty == "u32",
                _ => false,
            };
            is_known.then_some((builtin, name))
        };
        let inputs = inputs.split(", ").filter(|text| !text.is_empty());
        let inputs = inputs.map(|text| input(text).unwrap_or_else(|| panic!("{name}: the input {text}")));
        let size = [0, 1, 2].map(|axis| size.get(axis).copied().unwrap_or("1u"));
        Self { name, size, inputs: inputs.collect() }
    }

    fn input(&self, builtin: &str) -> Option<&'a str> {
        self.inputs.iter().find(|(own, _)| *own == builtin).map(|(_, name)| *name)
    }

    /// Returns the signature and the first statements of the body.
    fn rewritten(&self, map: Option<&str>, memory: &[Memory<'_>]) -> String {
        let [x, y, z] = self.size;
        let (group, global) = (self.input("workgroup_id"), self.input("global_invocation_id"));
        // Entry points that read no position run in a single workgroup.
        let is_mapped = map.is_some() && (group.is_some() || global.is_some());
        let mut inputs = self.inputs.clone();
        let mut require = |builtin: &'a str, name: &'a str| match self.input(builtin) {
            Some(name) => name,
            None => {
                inputs.push((builtin, name));
                name
            }
        };
        let local = (!memory.is_empty()).then(|| require("local_invocation_index", "order_local"));
        let groups = is_mapped.then(|| {
            require("workgroup_id", "order_id");
            require("num_workgroups", "order_groups")
        });
        let mut body = String::new();
        if let Some(local) = local {
            body += &format!("var order_word = {NAN};\n");
            body.extend(memory.iter().map(|own| own.filled(local, &format!("{x} * {y} * {z}"))));
            body += "workgroupBarrier();\n";
        }
        if let Some(groups) = groups {
            body += &format!("let order_to = order_map(order_id, {groups});\n");
            for (builtin, name) in &mut inputs {
                let mapped = match *builtin {
                    "workgroup_id" if *name != "order_id" => "order_to".to_owned(),
                    "global_invocation_id" => {
                        format!("order_global + (order_to - order_id) * vec3<u32>({x}, {y}, {z})")
                    }
                    _ => continue,
                };
                body += &format!("let {name} = {mapped};\n");
                *name = if *builtin == "workgroup_id" { "order_id" } else { "order_global" };
            }
        }
        let ty = |builtin: &str| if builtin == "local_invocation_index" { "u32" } else { "vec3<u32>" };
        let inputs =
            inputs.iter().map(|(builtin, name)| format!("@builtin({builtin}) {name}: {}", ty(builtin)));
        format!("fn {}({}) {{\n{body}", self.name, inputs.collect::<Vec<_>>().join(", "))
    }
}
