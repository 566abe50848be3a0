//! Textures as KTX 2.0 files with all mip levels (Khronos, KTX File Format Specification 2.0).

use super::{CardAlpha, CardTextures, NamedFile};
use crate::srgb;

/// First bytes of every file.
const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// `VK_FORMAT_R8G8B8A8_UNORM` and `VK_FORMAT_R8G8B8A8_SRGB`.
const FORMATS: [u32; 2] = [37, 43];
/// Bytes before the list of levels, and per level in the list.
const HEADER: usize = 80;
const LEVEL: usize = 24;
/// The program that wrote the file.
const WRITER: &[u8] = b"KTXwriter\0Tresses\0";
/// Coverage from which a mask is opaque.
const CUTOFF: f32 = 0.5;

impl CardTextures {
    /// Encodes all textures with their mip levels as KTX 2.0, 8 bits per channel, without compression. Colors and
    /// attributes of a level are means weighted by the coverage, colors in linear light. The coverage is the mean,
    /// which keeps the area of blended cards. For [`CardAlpha::Mask`], each level scales it so that the share of opaque
    /// texels is the mean coverage of the first level (Castaño 2010, "Computing Alpha Mipmaps").
    ///
    /// File names begin with `name`.
    pub fn ktx2(&self, name: &str, alpha: CardAlpha) -> Vec<NamedFile> {
        let coverage: Vec<u8> = self.color.iter().map(|texel| texel[3]).collect();
        let three = |texels: &[[u8; 3]]| texels.iter().map(|[a, b, c]| [*a, *b, *c, 255]).collect::<Vec<_>>();
        let textures = [
            ("color", self.color.clone(), true),
            ("surface", three(&self.surface), false),
            ("anisotropy", three(&self.anisotropy), false),
            ("data", self.data.clone(), false),
        ];
        let file = |(kind, texels, is_srgb): (&str, Vec<[u8; 4]>, bool)| {
            let covers = matches!(kind, "color" | "data");
            let mask = covers && alpha == CardAlpha::Mask;
            let levels = mips(self.size as usize, &texels, &coverage, (is_srgb, covers, mask));
            (format!("{name}_{kind}.ktx2"), encoded(self.size, &levels, is_srgb))
        };
        textures.into_iter().map(file).collect()
    }
}

/// Returns all levels, from the whole image to one texel. `covers`: the last channel is the coverage, else it stays
/// 255. `mask`: the share of opaque texels stays the same.
fn mips(
    size: usize,
    texels: &[[u8; 4]],
    coverage: &[u8],
    (is_srgb, covers, mask): (bool, bool, bool),
) -> Vec<Vec<[u8; 4]>> {
    let light = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if is_srgb { srgb::linear(value) } else { value }
    };
    let table: [f32; 256] = std::array::from_fn(|byte| light(byte as u8));
    let byte = |value: f32| (255.0 * value.clamp(0.0, 1.0) + 0.5) as u8;
    let encode = |value: f32| byte(if is_srgb { srgb::encoded(value) } else { value });
    // Attributes times weight, and weight.
    let mut sums: Vec<[f32; 4]> = texels
        .iter()
        .zip(coverage)
        .map(|(texel, coverage)| {
            // Texels without coverage count a little, so that empty areas keep their filled colors.
            let weight = f32::from(*coverage) / 255.0;
            let [r, g, b] = [0, 1, 2].map(|k| table[usize::from(texel[k])] * (weight + 1e-3));
            [r, g, b, weight]
        })
        .collect();
    let mean = sums.iter().map(|sum| f64::from(sum[3])).sum::<f64>() / sums.len().max(1) as f64;
    let mut levels = vec![texels.to_vec()];
    let mut edge = size;
    while edge > 1 {
        let half = edge / 2;
        sums = (0..half * half)
            .map(|i| {
                let at = 2 * (i / half) * edge + 2 * (i % half);
                let four = [at, at + 1, at + edge, at + edge + 1].map(|k| sums[k]);
                std::array::from_fn(|k| 0.25 * four.iter().map(|sum| sum[k]).sum::<f32>())
            })
            .collect();
        edge = half;
        let scale = if mask { opaque(&sums, mean) } else { 1.0 };
        let texel = |sum: &[f32; 4]| {
            let [r, g, b] = [0, 1, 2].map(|k| encode(sum[k] / (sum[3] + 1e-3)));
            [r, g, b, if covers { byte(scale * sum[3]) } else { 255 }]
        };
        levels.push(sums.iter().map(texel).collect());
    }
    levels
}

/// Returns the factor on the coverage with which the share `wanted` of the texels is opaque.
fn opaque(sums: &[[f32; 4]], target_fraction: f64) -> f32 {
    let mut coverage: Vec<f32> = sums.iter().map(|sum| sum[3]).collect();
    coverage.sort_by(|a, b| b.total_cmp(a));
    let count = (target_fraction * coverage.len() as f64).round() as usize;
    match coverage.get(count.saturating_sub(1)) {
        // A little more, so that rounding to bytes does not lose the last one.
        Some(last) if count > 0 && *last > 1e-3 => (CUTOFF + 0.004) / last,
        _ => 1.0,
    }
}

/// Encodes the levels of a square image.
fn encoded(size: u32, levels: &[Vec<[u8; 4]>], is_srgb: bool) -> Vec<u8> {
    let format = descriptor(is_srgb);
    let mut values = (WRITER.len() as u32).to_le_bytes().to_vec();
    values.extend(WRITER);
    values.resize(values.len().next_multiple_of(4), 0);
    let about = HEADER + LEVEL * levels.len();
    let start = about + format.len() + values.len();
    let mut file = IDENTIFIER.to_vec();
    let words = [FORMATS[usize::from(is_srgb)], 1, size, size, 0, 0, 1, levels.len() as u32, 0];
    let index = [about, format.len(), about + format.len(), values.len()].map(|n| n as u32);
    file.extend(words.iter().chain(&index).flat_map(|word| word.to_le_bytes()));
    // No supercompression.
    file.extend([0; 16]);
    // The smallest level comes first in the file, and last in the list.
    let bytes = |level: &Vec<[u8; 4]>| 4 * level.len();
    let after = |level: usize| levels[level + 1..].iter().map(bytes).sum::<usize>();
    for (i, level) in levels.iter().enumerate() {
        let list = [start + after(i), bytes(level), bytes(level)];
        file.extend(list.iter().flat_map(|n| (*n as u64).to_le_bytes()));
    }
    file.extend(format);
    file.extend(values);
    levels.iter().rev().for_each(|level| file.extend(level.as_flattened()));
    file
}

/// Returns the data format descriptor of four channels of 8 bits (Khronos Data Format Specification 1.3, section 5).
fn descriptor(is_srgb: bool) -> Vec<u8> {
    const SAMPLES: u32 = 4;
    let block = 24 + 16 * SAMPLES;
    // Color model RGBSDA, primaries of BT.709, transfer function linear or sRGB, straight alpha.
    let model = 1 | (1 << 8) | ((1 + u32::from(is_srgb)) << 16);
    let mut words = vec![4 + block, 0, 2 | (block << 16), model, 0, 4, 0];
    for (channel, kind) in (0..SAMPLES).zip([0, 1, 2, 15]) {
        // Alpha is linear in any case.
        let linear = if channel == 3 && is_srgb { 1 << 4 } else { 0 };
        let kind: u32 = kind | linear;
        words.extend([(8 * channel) | (7 << 16) | (kind << 24), 0, 0, 255]);
    }
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    /// Textures of 64² texels, a third of which strands cover.
    fn textures() -> CardTextures {
        let mut rng = Rng::new(3, 0);
        let color: Vec<[u8; 4]> = (0..64 * 64)
            .map(|_| [200, 100, 50, if rng.unit() < 0.33 { (128.0 + 127.0 * rng.unit()) as u8 } else { 0 }])
            .collect();
        CardTextures {
            size: 64,
            anisotropy: vec![[255, 128, 255]; color.len()],
            surface: vec![[255, 115, 0]; color.len()],
            data: color.clone(),
            depth: 0.01,
            has_colors: false,
            color,
        }
    }

    fn alpha(level: &[u8]) -> Vec<f32> {
        level.as_chunks::<4>().0.iter().map(|texel| f32::from(texel[3]) / 255.0).collect()
    }

    fn mean(values: &[f32]) -> f32 {
        values.iter().sum::<f32>() / values.len() as f32
    }

    #[test]
    fn files_have_all_levels_and_a_valid_header() {
        let files = textures().ktx2("hair", CardAlpha::Core);
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["hair_color.ktx2", "hair_surface.ktx2", "hair_anisotropy.ktx2", "hair_data.ktx2"]);
        for (name, bytes) in &files {
            let read = ::ktx2::Reader::new(bytes).unwrap();
            let header = read.header();
            let expected = if name.contains("color") {
                ::ktx2::Format::R8G8B8A8_SRGB
            } else {
                ::ktx2::Format::R8G8B8A8_UNORM
            };
            assert_eq!((header.format, header.pixel_width, header.pixel_height), (Some(expected), 64, 64));
            assert_eq!((header.level_count, header.face_count, header.supercompression_scheme), (7, 1, None));
            let sizes: Vec<usize> = read.levels().map(|level| level.data.len()).collect();
            assert_eq!(sizes, [64, 32, 16, 8, 4, 2, 1].map(|edge| 4 * edge * edge));
            let srgb = name.contains("color");
            let transfer =
                if srgb { ::ktx2::TransferFunction::SRGB } else { ::ktx2::TransferFunction::Linear };
            assert_eq!(
                (read.color_model(), read.transfer_function()),
                (Some(::ktx2::ColorModel::RGBSDA), Some(transfer))
            );
            assert!(read.writer().is_some_and(|writer| writer.starts_with("Tresses")));
        }
        let read = ::ktx2::Reader::new(&files[0].1).unwrap();
        let levels: Vec<_> = read.levels().map(|level| level.data.to_vec()).collect();
        assert_eq!(levels[0], textures().color.as_flattened());
        // Colors stay, and the area of blended cards is kept.
        let first = mean(&alpha(&levels[0]));
        for level in &levels {
            assert!((mean(&alpha(level)) - first).abs() < 0.003);
            assert!(level.as_chunks::<4>().0.iter().all(|t| t[0].abs_diff(200) < 2 && t[2].abs_diff(50) < 2));
        }
    }

    #[test]
    fn masks_keep_their_area() {
        let share = |kind| {
            let files = textures().ktx2("hair", kind);
            let read = ::ktx2::Reader::new(&files[0].1).unwrap();
            let share = |level: ::ktx2::Level<'_>| {
                let alpha = alpha(level.data);
                alpha.iter().filter(|alpha| **alpha >= CUTOFF).count() as f32 / alpha.len() as f32
            };
            read.levels().map(share).collect::<Vec<_>>()
        };
        let wanted = mean(&alpha(textures().color.as_flattened()));
        let (kept, lost) = (share(CardAlpha::Mask), share(CardAlpha::Core));
        for level in 1..5 {
            assert!((kept[level] - wanted).abs() < 0.04, "{kept:?} {wanted}");
        }
        // Without it, thin strands vanish.
        assert!(lost[3] < 0.5 * wanted, "{lost:?}");
    }
}
