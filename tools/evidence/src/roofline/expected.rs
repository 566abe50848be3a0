//! Operations of a shader as a GPU's compiler assumes them, by reflection.

use super::instrument::{CostReader, parse};
use anyhow::{Context, Result};
use std::collections::HashMap;
use wgpu::naga::{
    Arena, Block, Expression, Function, Handle, Module, Statement,
    valid::{FunctionInfo, ModuleInfo},
};

/// Returns the turns that Mesa's ACO assumes of a loop in `depth` others, when it estimates cycles.
fn loop_iterations(depth: u32) -> f64 {
    [8.0, 4.0, 2.0][depth.min(2) as usize]
}

/// Share of the waves that take a side of a branch, as ACO assumes.
const BRANCH_FRACTION: f64 = 0.75;

/// Returns the operations of an invocation of the compute shader `source` with the turns and branches that ACO assumes.
pub fn expected(source: &str) -> Result<f64> {
    let (module, info) = parse(source)?;
    let entry = module.entry_points.first().context("an entry point")?;
    let mut expectation = Expectation { module: &module, known: HashMap::new(), info: &info };
    Ok(expectation.function(&entry.function, info.get_entry_point(0), 0))
}

/// Expected operations of functions.
struct Expectation<'a> {
    module: &'a Module,
    info: &'a ModuleInfo,
    /// Of functions called in this many loops.
    known: HashMap<(Handle<Function>, u32), f64>,
}

impl Expectation<'_> {
    fn function(&mut self, function: &Function, info: &FunctionInfo, depth: u32) -> f64 {
        self.block(&function.body, &function.expressions, info, depth)
    }

    fn block(
        &mut self,
        block: &Block,
        expressions: &Arena<Expression>,
        info: &FunctionInfo,
        depth: u32,
    ) -> f64 {
        let reader = CostReader { module: self.module, info };
        let mut sum = 0.0;
        for statement in block {
            let mut inner = |block, depth| self.block(block, expressions, info, depth);
            sum += match statement {
                Statement::Block(block) => inner(block, depth),
                Statement::If { accept, reject, .. } => {
                    BRANCH_FRACTION * (inner(accept, depth) + inner(reject, depth))
                }
                Statement::Switch { cases, .. } => {
                    BRANCH_FRACTION * cases.iter().map(|case| inner(&case.body, depth)).sum::<f64>()
                }
                Statement::Loop { body, continuing, .. } => {
                    loop_iterations(depth) * (inner(body, depth + 1) + inner(continuing, depth + 1))
                }
                Statement::Call { function, .. } => self.call(*function, depth),
                other => f64::from(reader.operations(expressions, other)),
            };
        }
        sum
    }

    fn call(&mut self, of: Handle<Function>, depth: u32) -> f64 {
        if let Some(known) = self.known.get(&(of, depth)) {
            return *known;
        }
        let (module, info) = (self.module, self.info);
        let found = self.function(&module.functions[of], &info[of], depth);
        self.known.insert((of, depth), found);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expected_operations_follow_loops_branches_and_calls() {
        let of = |body: &str| {
            let source = format!(
                "@group(0) @binding(0) var<storage, read_write> x: f32;
                fn one(a: f32) -> f32 {{ return a + 1.0; }}
                fn two() {{ loop {{ x = one(x); break; }} }}
                @compute @workgroup_size(1) fn main() {{ {body} }}"
            );
            expected(&source).unwrap()
        };
        assert_eq!(of("x = x + 1.0;"), 1.0);
        assert_eq!(of("x = one(x); x = one(x);"), 2.0);
        assert_eq!(of("two();"), 8.0);
        assert_eq!(of("loop { two(); break; }"), 8.0 * 4.0);
        assert_eq!(of("loop { loop { two(); break; } break; }"), 8.0 * 4.0 * 2.0);
        // The comparison, and three quarters of the sum.
        assert_eq!(of("if x > 0.0 { x = one(x); }"), 1.75);
    }
}
