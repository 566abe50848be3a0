//! Instruments shaders to count their work per invocation: operations, loads, bytes, texels and atomics.
//!
//! Statements between branches and loops always execute together. Their cost is therefore summed up when the shader is
//! instrumented, and added in one step at run time. Each invocation sums its counts in private memory and adds them to
//! a buffer when it ends. Loops are thus counted once per iteration, and branches only if taken.

use anyhow::{Context, Result};
use tresses::low_level::probe::GROUP;
use wgpu::naga::{
    AddressSpace, Arena, Block, Expression, Function, GlobalVariable, Handle, ImageClass, Literal,
    MathFunction as Fun, Module, ShaderStage, Span, Statement, TypeInner,
    front::wgsl,
    proc::GlobalCtx,
    valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator},
};

/// Number of bindings of `@group(0)` whose bytes are counted separately.
pub const BINDINGS: usize = 16;
/// Number of counters, in the order of [`ShaderCounts`].
const FIELDS: usize = 8 + 2 * BINDINGS;
/// Size of the counters of a dispatch or draw, 64 bits each.
pub const BYTES: u64 = 8 * FIELDS as u64;

const INVOCATIONS: usize = 0;
const OPERATIONS: usize = 1;
const LOADS: usize = 2;
const TEXELS: usize = 3;
const TEXEL_BYTES: usize = 4;
const ATOMICS: usize = 5;
const READ: usize = 8;
const WRITTEN: usize = READ + BINDINGS;
/// Bytes read and written through other bind groups.
const OTHERS: [usize; 2] = [6, 7];

/// Work of the invocations of a dispatch, or of the fragments of a draw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaderCounts {
    /// Started invocations.
    pub invocations: u64,
    /// Arithmetic operations on scalars, one per component.
    pub operations: u64,
    /// Loads from storage buffers.
    pub loads: u64,
    /// Loaded texels, and samples taken by samplers.
    pub texels: u64,
    /// Bytes stored to textures.
    pub texel_bytes: u64,
    /// Atomic operations on storage buffers.
    pub atomics: u64,
    /// Bytes loaded from and stored to storage buffers of `@group(0)`, by binding.
    pub bound: [[u64; 2]; BINDINGS],
    /// Bytes loaded and stored through other bind groups.
    pub others: [u64; 2],
}

impl ShaderCounts {
    /// Reads the counters from the first [`BYTES`] of `words`.
    pub fn read(words: &[u32]) -> Self {
        let at = |field: usize| u64::from(words[2 * field]) | u64::from(words[2 * field + 1]) << 32;
        Self {
            invocations: at(INVOCATIONS),
            operations: at(OPERATIONS),
            loads: at(LOADS),
            texels: at(TEXELS),
            texel_bytes: at(TEXEL_BYTES),
            atomics: at(ATOMICS),
            bound: std::array::from_fn(|i| [at(READ + i), at(WRITTEN + i)]),
            others: OTHERS.map(at),
        }
    }
}

/// Parses and validates the shader `source`.
pub fn parse(source: &str) -> Result<(Module, ModuleInfo)> {
    let module = wgsl::parse_str(source).map_err(|error| anyhow::anyhow!(error.emit_to_string(source)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module)?;
    Ok((module, info))
}

/// Instruments the shader `source`. Vertex shaders are not counted, because they cannot write to storage.
pub fn instrument(source: &str) -> Result<Module> {
    // The counting functions come first, before their callers.
    let source = format!(
        "@group({GROUP}) @binding(0) var<storage, read_write> tally_sums: array<atomic<u32>, {0}>;
        var<private> tally_counts: array<u32, {FIELDS}>;
        fn tally_add(field: u32, count: u32) {{ tally_counts[field] += count; }}
        fn tally_end() {{
            for (var i = 0u; i < {FIELDS}u; i++) {{
                let count = tally_counts[i];
                if count > 0u {{
                    let before = atomicAdd(&tally_sums[2u * i], count);
                    if before + count < before {{ atomicAdd(&tally_sums[2u * i + 1u], 1u); }}
                }}
            }}
        }}
        {source}",
        2 * FIELDS
    );
    let (mut module, info) = parse(&source)?;
    let handle = |name: &str| {
        let found = module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(name));
        found.map(|(handle, _)| handle).context("a function of the tally")
    };
    let [add, end] = [handle("tally_add")?, handle("tally_end")?];
    let before = module.clone();
    let counter = |info, end| Counter { reader: CostReader { module: &before, info }, add, end };
    for (handle, function) in module.functions.iter_mut().filter(|(handle, _)| ![add, end].contains(handle)) {
        counter(&info[handle], None).function(function);
    }
    for (i, entry) in module.entry_points.iter_mut().enumerate() {
        let end = (entry.stage != ShaderStage::Vertex).then_some(end);
        counter(info.get_entry_point(i), end).function(&mut entry.function);
    }
    Ok(module)
}

/// Instruments one function.
struct Counter<'a> {
    reader: CostReader<'a>,
    add: Handle<Function>,
    /// Function that an entry point calls before it returns.
    end: Option<Handle<Function>>,
}

type Costs = [u32; FIELDS];

impl Counter<'_> {
    fn function(&self, function: &mut Function) {
        let body = std::mem::take(&mut function.body);
        let mut body = self.block(&mut function.expressions, body, self.end.is_some());
        if let Some(end) = self.end
            && !matches!(body.last(), Some(Statement::Return { .. } | Statement::Kill))
        {
            body.push(call(end, Vec::new()), Span::UNDEFINED);
        }
        function.body = body;
    }

    /// Instruments `block`; `first` marks the body of an entry point.
    fn block(&self, expressions: &mut Arena<Expression>, block: Block, first: bool) -> Block {
        let mut counting = Block::new();
        let mut costs = [0; FIELDS];
        costs[INVOCATIONS] = u32::from(first);
        // Statements that execute together. A branch or loop ends the run, since it may return.
        let mut together = Block::new();
        for (statement, span) in block.span_into_iter() {
            let mut inner = |block| self.block(expressions, block, false);
            let statement = match statement {
                Statement::Block(block) => Statement::Block(inner(block)),
                Statement::If { condition, accept, reject } => {
                    Statement::If { condition, accept: inner(accept), reject: inner(reject) }
                }
                Statement::Switch { selector, mut cases } => {
                    for case in &mut cases {
                        case.body = inner(std::mem::take(&mut case.body));
                    }
                    Statement::Switch { selector, cases }
                }
                Statement::Loop { body, continuing, break_if } => {
                    Statement::Loop { body: inner(body), continuing: inner(continuing), break_if }
                }
                plain => {
                    self.reader.statement(expressions, &plain, &mut costs);
                    if let (Some(end), Statement::Return { .. } | Statement::Kill) = (self.end, &plain) {
                        together.push(call(end, Vec::new()), Span::UNDEFINED);
                    }
                    together.push(plain, span);
                    continue;
                }
            };
            self.count(expressions, &mut counting, std::mem::replace(&mut costs, [0; FIELDS]));
            counting.append(&mut together);
            counting.push(statement, span);
        }
        self.count(expressions, &mut counting, costs);
        counting.append(&mut together);
        counting
    }

    /// Appends calls to `block` that add `costs`.
    fn count(&self, expressions: &mut Arena<Expression>, block: &mut Block, costs: Costs) {
        for (field, cost) in costs.into_iter().enumerate().filter(|(_, cost)| *cost > 0) {
            let mut word =
                |word| expressions.append(Expression::Literal(Literal::U32(word)), Span::UNDEFINED);
            let arguments = vec![word(field as u32), word(cost)];
            block.push(call(self.add, arguments), Span::UNDEFINED);
        }
    }
}

/// Reads the costs of a function's statements.
pub(super) struct CostReader<'a> {
    pub module: &'a Module,
    pub info: &'a FunctionInfo,
}

impl CostReader<'_> {
    /// Returns the operations of a statement, without the operations of its blocks.
    pub fn operations(&self, expressions: &Arena<Expression>, statement: &Statement) -> u32 {
        let mut costs = [0; FIELDS];
        self.statement(expressions, statement, &mut costs);
        costs[OPERATIONS]
    }

    fn statement(&self, expressions: &Arena<Expression>, statement: &Statement, costs: &mut Costs) {
        match statement {
            Statement::Emit(range) => {
                range.clone().for_each(|expression| self.expression(expressions, expression, costs));
            }
            Statement::Store { pointer, value } => {
                if let Some((read, written)) = self.fields(expressions, *pointer) {
                    debug_assert_ne!(read, written);
                    costs[written] += self.size(*value);
                }
            }
            Statement::ImageStore { image, .. } => {
                if let TypeInner::Image { class: ImageClass::Storage { format, .. }, .. } = self.inner(*image)
                {
                    // The name of a format contains its bits per channel.
                    costs[TEXEL_BYTES] += bits(&format!("{format:?}")) / 8;
                }
            }
            Statement::Atomic { pointer, .. } => match self.fields(expressions, *pointer) {
                Some(_) => costs[ATOMICS] += 1,
                None => costs[OPERATIONS] += 1,
            },
            _ => {}
        }
    }

    fn expression(&self, expressions: &Arena<Expression>, of: Handle<Expression>, costs: &mut Costs) {
        costs[OPERATIONS] += match expressions[of] {
            Expression::Load { pointer } => {
                if let Some((read, _)) = self.fields(expressions, pointer) {
                    costs[read] += self.size(of);
                    costs[LOADS] += 1;
                }
                0
            }
            Expression::ImageLoad { .. } | Expression::ImageSample { .. } => {
                costs[TEXELS] += 1;
                0
            }
            Expression::Binary { left, right, .. } => match (self.inner(left), self.inner(right)) {
                // Matrix products: one multiplication and one addition per pair of scalars.
                (TypeInner::Matrix { .. }, TypeInner::Vector { .. }) => 2 * self.width(left),
                (TypeInner::Vector { .. }, TypeInner::Matrix { .. }) => 2 * self.width(right),
                (TypeInner::Matrix { columns, .. }, TypeInner::Matrix { columns: across, .. })
                    if self.width(of) == self.width(left) / *columns as u32 * *across as u32 =>
                {
                    2 * self.width(left) * *across as u32
                }
                // Comparisons of vectors also count one per component.
                _ => self.width(of),
            },
            Expression::Unary { .. } | Expression::Select { .. } | Expression::Derivative { .. } => {
                self.width(of)
            }
            Expression::As { convert: Some(_), .. } => self.width(of),
            Expression::Relational { argument, .. } => self.width(argument),
            Expression::Math { fun, arg, .. } => {
                let n = self.width(arg);
                match fun {
                    Fun::Dot => 2 * n - 1,
                    Fun::Cross => 9,
                    Fun::Length | Fun::Clamp | Fun::Fma => 2 * n,
                    Fun::Normalize | Fun::Distance | Fun::Mix | Fun::Pow => 3 * n,
                    Fun::Reflect => 4 * n,
                    Fun::SmoothStep => 7 * n,
                    Fun::Transpose => 0,
                    _ => n.max(self.width(of)),
                }
            }
            _ => 0,
        };
    }

    fn inner(&self, of: Handle<Expression>) -> &TypeInner {
        self.info[of].ty.inner_with(&self.module.types)
    }

    /// Returns the number of scalars in a value.
    fn width(&self, of: Handle<Expression>) -> u32 {
        match self.inner(of) {
            TypeInner::Vector { size, .. } => *size as u32,
            TypeInner::Matrix { columns, rows, .. } => *columns as u32 * *rows as u32,
            _ => 1,
        }
    }

    fn size(&self, of: Handle<Expression>) -> u32 {
        let context: GlobalCtx<'_> = self.module.to_ctx();
        self.inner(of).try_size(context).unwrap_or(0)
    }

    /// Returns the counters of bytes read and written through a pointer into a storage buffer.
    fn fields(
        &self,
        expressions: &Arena<Expression>,
        mut pointer: Handle<Expression>,
    ) -> Option<(usize, usize)> {
        let global: &GlobalVariable = loop {
            match expressions[pointer] {
                Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => pointer = base,
                Expression::GlobalVariable(global) => break &self.module.global_variables[global],
                _ => return None,
            }
        };
        let AddressSpace::Storage { .. } = global.space else { return None };
        let at = global.binding.filter(|at| at.group == 0 && (at.binding as usize) < BINDINGS);
        Some(at.map_or(OTHERS.into(), |at| (READ + at.binding as usize, WRITTEN + at.binding as usize)))
    }
}

fn call(function: Handle<Function>, arguments: Vec<Handle<Expression>>) -> Statement {
    Statement::Call { function, arguments, result: None }
}

/// Returns the bits per texel of a format; `Rgba16Float` has 4 channels of 16 bits.
fn bits(format: &str) -> u32 {
    let number: String = format.chars().filter(char::is_ascii_digit).collect();
    let channels = format.chars().take_while(|c| !c.is_ascii_digit()).count() as u32;
    channels * number.parse().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_follow_from_the_format_name() {
        assert_eq!([bits("Rgba16Float"), bits("R32Uint"), bits("Rgba8Unorm")], [64, 32, 32]);
    }

    #[test]
    fn every_shader_can_be_instrumented() {
        for (name, wgsl) in tresses::low_level::shaders::all() {
            let module = instrument(wgsl).unwrap_or_else(|error| panic!("{name}: {error}"));
            let checked = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
            assert!(checked.is_ok(), "{name}: {checked:?}");
        }
    }

    /// Runs a known shader on 96 threads with `turns` loop iterations, and returns its counts.
    fn counted(turns: u32) -> Option<ShaderCounts> {
        let wgsl = "
            @group(0) @binding(0) var<storage, read> turns: array<u32>;
            @group(0) @binding(1) var<storage, read_write> out: array<vec4f>;
            @group(0) @binding(2) var<storage, read_write> sum: atomic<u32>;
            fn twice(x: vec4f) -> vec4f { return x + x; }
            @compute @workgroup_size(32) fn main(@builtin(global_invocation_id) id: vec3u) {
                if id.x >= 64u { return; }
                var x = vec4f(1.0);
                for (var i = 0u; i < turns[0]; i++) { x = twice(x); }
                if id.x < 10u { atomicAdd(&sum, 1u); }
                out[id.x] = x;
            }";
        let gpu = tresses_testing::gpu_or_skip(pollster::block_on(tresses::Gpu::open()))?;
        let context = &gpu.context;
        let (device, queue) = (context.device(), context.queue());
        let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(instrument(wgsl).expect("it counts")));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let buffer = |size| {
            let usage =
                wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let buffers = [4, 16 * 64, 4, BYTES].map(buffer);
        queue.write_buffer(&buffers[0], 0, &turns.to_le_bytes());
        let group = |index, buffers: &[wgpu::Buffer]| {
            let entries: Vec<_> = (0..)
                .zip(buffers)
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let layout = &pipeline.get_bind_group_layout(index);
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group(0, &buffers[..3]), &[]);
        pass.set_bind_group(GROUP, &group(GROUP, &buffers[3..]), &[]);
        pass.dispatch_workgroups(3, 1, 1);
        drop(pass);
        queue.submit([encoder.finish()]);
        let words: Vec<u32> =
            tresses::low_level::readback::blocking::buffer(context, &buffers[3]).expect("back");
        Some(ShaderCounts::read(&words))
    }

    #[test]
    fn counts_match_a_known_shader() {
        let Some(counted) = counted(5) else { return };
        let mut bound = [[0; 2]; BINDINGS];
        // The loop condition loads `turns[0]` once more than there are iterations. 64 of 96 threads pass the first
        // branch.
        bound[0][0] = 64 * 6 * 4;
        bound[1][1] = 64 * 16;
        let expected = ShaderCounts {
            invocations: 96,
            // First branch; six loop conditions, five increments, five sums of four components; second branch.
            operations: 96 + 64 * (6 + 5 * (1 + 4) + 1),
            loads: 64 * 6,
            atomics: 10,
            bound,
            ..ShaderCounts::default()
        };
        assert_eq!(counted, expected);
        let Some(more) = self::counted(6) else { return };
        assert_eq!((more.loads - 64 * 7, more.operations - counted.operations), (0, 64 * 6));
    }
}
