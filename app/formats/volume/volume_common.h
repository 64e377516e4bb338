#pragma once

#include "app/base/text.h"
#include "app/base/world_budget.h"
#include "app/formats/volume/volume.h"
#include "qnv/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What the readers of volumes share.
namespace gs::app {

/// A volume, or what is wrong with the file.
using VolumeResult = std::variant<qnv::VolumeSource, std::string>;

/// Bytes in memory that is drawn from a budget for voxels.
struct VoxelMemory {
  std::vector<std::byte> bytes;
  vrml::Share share;
};
[[nodiscard]] SharedBytes shared_bytes(VoxelMemory memory);
/// `size` bytes for what is unpacked of `from` bytes, or why there are none: the budget, or more than deflate can make
/// of what is there (RFC 1951: 258 bytes from 2 bits).
[[nodiscard]] std::variant<VoxelMemory, std::string> voxel_memory(std::uint64_t from, std::uint64_t size,
                                                                  const WorldBudget& budget);

/// Maps a file, and unpacks it when it is gzip'd.
[[nodiscard]] BytesResult load_bytes(const std::string& path, const WorldBudget& budget);
/// Unpacks gzip members to the end.
[[nodiscard]] BytesResult unpacked_gzip(std::span<const std::byte> bytes, const WorldBudget& budget);
/// Unpacks zlib or gzip data of exactly `size` bytes; more is ignored, fewer are an error.
[[nodiscard]] BytesResult unpacked_exactly(std::span<const std::byte> bytes, std::uint64_t size,
                                           const WorldBudget& budget);
/// The same, into memory that there is. What is wrong, or nothing.
[[nodiscard]] std::optional<std::string> unpack_into(std::span<const std::byte> bytes, std::span<std::byte> out,
                                                     const WorldBudget& budget);

/// A file that is being opened.
struct VolumeFile {
  std::string path, name;  // the name is that of where it came from
  SharedBytes content;     // unpacked
  ReadFile read_beside;
  WorldBudget budget = own_budget();
};
/// The file that a header names by a path, where it may be read (see ReadFile); else the file of that name beside the
/// header. Unpacked as load_bytes does.
[[nodiscard]] BytesResult load_beside(const VolumeFile& file, std::string_view name);

/// What stored voxels may be; 64-bit integers are widened to f64 when they are read.
enum class StoredType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64, u64, i64 };
[[nodiscard]] std::size_t size_of(StoredType type);

/// Voxels as they lie in a file: x fastest, `components` numbers each, of which the first counts.
struct StoredVoxels {
  SharedBytes content;
  std::uint64_t offset = 0;  // of the first voxel
  StoredType type = StoredType::u8;
  bool big_endian = false;
  std::uint64_t components = 1;
};

/// The source of these voxels. `layout` needs all but type and big_endian. Fails when the bytes are not all there, or
/// the layout is not sound; what can be mended is (see `mend`).
[[nodiscard]] VolumeResult make_source(qnv::VolumeLayout layout, StoredVoxels voxels);

/// The bytes of a layout's voxels, or what is wrong with so many.
[[nodiscard]] std::variant<std::uint64_t, std::string> stored_size(const qnv::VolumeLayout& layout, StoredType type,
                                                                   std::uint64_t components);

/// Reads numbers parted by blanks or commas as voxels of a type, or of f64 where one of them is none of the type (1.5 or
/// 256 of u8); fails when there are fewer than `count`.
[[nodiscard]] std::variant<StoredVoxels, std::string> voxels_of_text(std::span<const std::byte> text,
                                                                     std::uint64_t count, StoredType type,
                                                                     const WorldBudget& budget);

/// Makes a layout sound where only its place in space is wrong: axes that are not finite, zero, or do not span
/// space become the unit axes, an origin that is not finite 0, a slope of 0 or one that is not finite 1.
void mend(qnv::VolumeLayout& layout);

/// All numbers of a text in which blanks, commas, parentheses and brackets part them; stops at anything
/// else, and at `most`.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text, std::size_t most);
/// The dimensions of a volume, or nothing when one of them is no whole number from 1 to 2^32 - 1. Fewer
/// than three numbers: the others are 1.
[[nodiscard]] std::optional<std::array<std::uint32_t, 3>> dimensions_of(std::span<const double> numbers);
/// Adds a pair to the metadata, unless it is empty: at most some thousand bytes, bytes that are no UTF-8
/// replaced by '?'.
void add_metadata(qnv::VolumeLayout& layout, std::string_view key, std::string_view value);

/// A row of the table of formats.
struct VolumeFormat {
  VolumeFormatName name;
  bool (*sniff)(std::span<const std::byte> bytes);  // by the first bytes; null: only the name tells
  VolumeResult (*open)(const VolumeFile& file);
};
/// The table of all.
[[nodiscard]] std::span<const VolumeFormat> volume_formats();
[[nodiscard]] bool is_avs_field(std::span<const std::byte> bytes);
[[nodiscard]] bool is_nrrd(std::span<const std::byte> bytes);
[[nodiscard]] bool is_meta_image(std::span<const std::byte> bytes);
[[nodiscard]] bool is_nifti(std::span<const std::byte> bytes);
[[nodiscard]] bool is_fits(std::span<const std::byte> bytes);
[[nodiscard]] bool is_slc(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vti(std::span<const std::byte> bytes);
[[nodiscard]] VolumeResult open_avs_field(const VolumeFile& file);
[[nodiscard]] VolumeResult open_nrrd(const VolumeFile& file);
[[nodiscard]] VolumeResult open_meta_image(const VolumeFile& file);
[[nodiscard]] VolumeResult open_nifti(const VolumeFile& file);
[[nodiscard]] VolumeResult open_fits(const VolumeFile& file);
[[nodiscard]] VolumeResult open_slc(const VolumeFile& file);
[[nodiscard]] VolumeResult open_vti(const VolumeFile& file);
[[nodiscard]] VolumeResult open_raw(const VolumeFile& file, const RawVolume& raw);

}  // namespace gs::app
