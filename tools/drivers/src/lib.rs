//! Statistics that a Vulkan driver reports of compute kernels (`VK_KHR_pipeline_executable_properties`).
//!
//! Mesa's drivers also compile for chips that are not there: RADV by a variable, others with a library that stands in
//! for the kernel's driver. wgpu cannot use RADV then, because it submits commands when it opens a device; this crate
//! only compiles. It is the only one here with unsafe code: the calls of the Vulkan interface.

use anyhow::{Context, Result, ensure};
use ash::{Device, Entry, Instance, khr::pipeline_executable_properties, vk};

/// Kind of a shader's resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResourceKind {
    /// Storage buffer.
    Storage,
    /// Uniform buffer.
    Uniform,
    /// Sampled texture.
    Texture,
    /// Storage texture.
    Image,
    /// Sampler.
    Sampler,
}

/// Resource of a shader: bind group, binding, kind.
pub type Resource = (u32, u32, ResourceKind);

/// Statistics that a driver reports of a kernel.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Threads that run in lockstep.
    pub lanes: u32,
    /// The driver's numbers by its names.
    pub numbers: Vec<(String, u64)>,
}

impl Statistics {
    /// Returns the number with the name `key`.
    pub fn get(&self, key: &str) -> Option<u64> {
        self.numbers.iter().find(|(name, _)| name == key).map(|(_, number)| *number)
    }
}

/// Most bind groups of a shader.
const GROUPS: usize = 4;

/// A device of a driver, which compiles.
pub struct Compiler {
    device: Device,
    statistics: pipeline_executable_properties::Device,
    instance: Instance,
    /// Name of the device, and version of its driver.
    pub name: String,
    _entry: Entry,
}

impl Compiler {
    /// Opens the first device of the drivers that the Vulkan loader finds.
    ///
    /// # Errors
    /// Fails without a loader, a driver, a device or the extension.
    pub fn open() -> Result<Self> {
        // SAFETY: the loader is a Vulkan loader. Every handle is used with the object that made it, and only before
        // `drop`; every structure outlives the call that reads it.
        unsafe {
            let entry = Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let instance = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&instance, None)?;
            let physical = instance.enumerate_physical_devices()?;
            let physical = *physical.first().context("the driver has no device")?;
            let mut driver = vk::PhysicalDeviceDriverProperties::default();
            let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
            instance.get_physical_device_properties2(physical, &mut properties);
            let name = properties.properties.device_name_as_c_str()?.to_string_lossy().trim().to_owned();
            let driver = driver.driver_info_as_c_str()?.to_string_lossy().into_owned();
            // All features, since kernels need some.
            let mut of_1_1 = vk::PhysicalDeviceVulkan11Features::default();
            let mut of_1_2 = vk::PhysicalDeviceVulkan12Features::default();
            let mut features =
                vk::PhysicalDeviceFeatures2::default().push_next(&mut of_1_1).push_next(&mut of_1_2);
            instance.get_physical_device_features2(physical, &mut features);
            let plain = features.features;
            // The query has linked them already.
            (of_1_1.p_next, of_1_2.p_next) = (std::ptr::null_mut(), std::ptr::null_mut());
            let mut executable = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
                .pipeline_executable_info(true);
            let mut features = vk::PhysicalDeviceFeatures2::default()
                .features(plain)
                .push_next(&mut of_1_1)
                .push_next(&mut of_1_2)
                .push_next(&mut executable);
            let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let extensions = [pipeline_executable_properties::NAME.as_ptr()];
            let device = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions)
                .push_next(&mut features);
            let device = instance.create_device(physical, &device, None)?;
            let statistics = pipeline_executable_properties::Device::new(&instance, &device);
            Ok(Self { device, statistics, instance, name: format!("{name}, {driver}"), _entry: entry })
        }
    }

    /// Compiles the compute shader `spirv` and returns the driver's statistics.
    ///
    /// # Errors
    /// Fails if the driver rejects it.
    pub fn statistics(&self, spirv: &[u32], entry: &str, resources: &[Resource]) -> Result<Statistics> {
        let mut bindings: [Vec<vk::DescriptorSetLayoutBinding<'_>>; GROUPS] = Default::default();
        for (group, binding, kind) in resources {
            let kind = match kind {
                ResourceKind::Storage => vk::DescriptorType::STORAGE_BUFFER,
                ResourceKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
                ResourceKind::Texture => vk::DescriptorType::SAMPLED_IMAGE,
                ResourceKind::Image => vk::DescriptorType::STORAGE_IMAGE,
                ResourceKind::Sampler => vk::DescriptorType::SAMPLER,
            };
            bindings.get_mut(*group as usize).context("too many bind groups")?.push(
                vk::DescriptorSetLayoutBinding::default()
                    .binding(*binding)
                    .descriptor_type(kind)
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE),
            );
        }
        let entry = std::ffi::CString::new(entry)?;
        // SAFETY: as in `open`. `spirv` is valid: it comes from a translator that validates. Everything that is made
        // here is destroyed here, unless an error ends the program's use of the device.
        unsafe {
            let device = &self.device;
            let mut sets = Vec::new();
            for bindings in &bindings {
                let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(bindings);
                sets.push(device.create_descriptor_set_layout(&set, None)?);
            }
            let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            let layout = device.create_pipeline_layout(&layout, None)?;
            let module =
                device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(spirv), None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(&entry);
            let pipeline = vk::ComputePipelineCreateInfo::default()
                .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
                .stage(stage)
                .layout(layout);
            let pipelines = device
                .create_compute_pipelines(vk::PipelineCache::null(), &[pipeline], None)
                .map_err(|(_, error)| error)?;
            let executable = vk::PipelineExecutableInfoKHR::default().pipeline(pipelines[0]);
            let found = self.statistics.get_pipeline_executable_statistics(&executable)?;
            let of_pipeline = vk::PipelineInfoKHR::default().pipeline(pipelines[0]);
            let executables = self.statistics.get_pipeline_executable_properties(&of_pipeline)?;
            let lanes = executables.first().map_or(0, |executable| executable.subgroup_size);
            let mut numbers = Vec::new();
            for statistic in &found {
                // Floats and flags are left out.
                let number = match statistic.format {
                    vk::PipelineExecutableStatisticFormatKHR::UINT64 => statistic.value.u64,
                    vk::PipelineExecutableStatisticFormatKHR::INT64 => statistic.value.i64 as u64,
                    _ => continue,
                };
                numbers.push((statistic.name_as_c_str()?.to_string_lossy().into_owned(), number));
            }
            device.destroy_pipeline(pipelines[0], None);
            device.destroy_shader_module(module, None);
            device.destroy_pipeline_layout(layout, None);
            sets.iter().for_each(|set| device.destroy_descriptor_set_layout(*set, None));
            ensure!(!numbers.is_empty(), "the driver reports no statistics");
            Ok(Statistics { lanes, numbers })
        }
    }
}

impl Drop for Compiler {
    fn drop(&mut self) {
        // SAFETY: all objects of the device are destroyed, and its handles have no other owner.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}
