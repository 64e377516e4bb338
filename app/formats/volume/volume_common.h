#pragma once

#include "app/formats/volume/volume.h"
#include "base/budget.h"
#include "base/text.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Functions that all volume readers share.
namespace gs::app {

/// Volume, or an error message.
using VolumeResult = std::variant<qnv::VolumeSource, std::string>;

/// Buffer charged to a voxel budget.
struct VoxelMemory {
  std::vector<std::byte> bytes;
  Share share;
};
[[nodiscard]] SharedBytes shared_bytes(VoxelMemory memory);
/// Allocates `size` bytes to decompress `from` bytes of input. Returns a message if the budget is exceeded, or if
/// deflate cannot expand that much (RFC 1951: 258 bytes from 2 bits).
[[nodiscard]] std::variant<VoxelMemory, std::string> voxel_memory(std::uint64_t from, std::uint64_t size,
                                                                  const WorldBudget& budget);

/// Maps a file, and decompresses it if it is gzip-compressed.
[[nodiscard]] BytesResult load_bytes(const std::string& path, const WorldBudget& budget);
/// Decompresses all gzip members.
[[nodiscard]] BytesResult unpacked_gzip(std::span<const std::byte> bytes, const WorldBudget& budget);
/// Decompresses zlib or gzip data of exactly `size` bytes. Ignores excess data; too little data is an error.
[[nodiscard]] BytesResult unpacked_exactly(std::span<const std::byte> bytes, std::uint64_t size,
                                           const WorldBudget& budget);
/// Decompresses like unpacked_exactly into `out`. Returns a message on failure.
[[nodiscard]] std::optional<std::string> unpack_into(std::span<const std::byte> bytes, std::span<std::byte> out,
                                                     const WorldBudget& budget);

/// Volume file being opened.
struct VolumeFile {
  std::string path, name;  // `name` is that of the original source
  SharedBytes content;     // decompressed
  ReadFile read_beside;
  WorldBudget budget = own_budget();
};
/// Loads a file that a header names: through `read_beside` (see ReadFile), else from the header's folder. Decompresses
/// it like load_bytes.
[[nodiscard]] BytesResult load_beside(const VolumeFile& file, std::string_view name);

/// Voxel type in a file. 64-bit integers are widened to f64 when read.
enum class StoredType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64, u64, i64 };
[[nodiscard]] std::size_t size_of(StoredType type);

/// Voxels as stored in a file: x fastest, with `components` numbers per voxel; only the first one is used.
struct StoredVoxels {
  SharedBytes content;
  std::uint64_t offset = 0;  // of the first voxel
  StoredType type = StoredType::u8;
  bool big_endian = false;
  std::uint64_t components = 1;
};

/// Creates the source of these voxels. `layout` needs all members except type and big_endian. Repairs the layout if
/// possible (see `mend`). Fails if bytes are missing or the layout is invalid.
[[nodiscard]] VolumeResult make_source(qnv::VolumeLayout layout, StoredVoxels voxels);

/// Returns the total size of the voxels in bytes, or a message if it is too large.
[[nodiscard]] std::variant<std::uint64_t, std::string> stored_size(const qnv::VolumeLayout& layout, StoredType type,
                                                                   std::uint64_t components);

/// Parses numbers separated by blanks or commas as voxels of a type. Uses f64 if one does not fit the type (1.5 or 256
/// for u8). Fails if there are fewer than `count`.
[[nodiscard]] std::variant<StoredVoxels, std::string> voxels_of_text(std::span<const std::byte> text,
                                                                     std::uint64_t count, StoredType type,
                                                                     const WorldBudget& budget);

/// Repairs the spatial part of a layout: unusable axes (not finite, zero or coplanar) become unit axes, a non-finite
/// origin 0, an invalid slope 1.
void mend(qnv::VolumeLayout& layout);

/// Parses numbers separated by blanks, commas, parentheses or brackets. Stops at other characters, or after `most`
/// numbers.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text, std::size_t most);
/// Converts numbers to dimensions; missing ones are 1. Returns nullopt unless all are integers from 1 to 2^32 - 1.
[[nodiscard]] std::optional<std::array<std::uint32_t, 3>> dimensions_of(std::span<const double> numbers);
/// Adds a metadata pair unless it is empty. Limits it to some thousand bytes and replaces invalid UTF-8 by '?'.
void add_metadata(qnv::VolumeLayout& layout, std::string_view key, std::string_view value);

/// Row of the format table.
struct VolumeFormat {
  VolumeFormatName name;
  bool (*sniff)(std::span<const std::byte> bytes);  // checks the first bytes; null means detection by name only
  VolumeResult (*open)(const VolumeFile& file);
};
/// Returns all formats.
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
