#pragma once

#include "app/formats/volume/volume.h"
#include "base/budget.h"
#include "base/nth_type.h"
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

/// Functions and types that all volume readers share.
namespace gs::app {

/// Volume, or an error message.
using VolumeResult = std::variant<qnv::VolumeSource, std::string>;

/// Buffer for voxels with its share of a budget.
struct VoxelMemory {
  std::vector<std::byte> bytes;
  Share share;
};
[[nodiscard]] SharedBytes shared_bytes(VoxelMemory memory);
/// Allocates `size` bytes for the decompression of `from` bytes. Returns a message if the budget is exceeded. Also does
/// so if deflate cannot expand that much: 2 bits give at most 258 bytes (RFC 1951).
[[nodiscard]] std::variant<VoxelMemory, std::string> voxel_memory(std::uint64_t from, std::uint64_t size,
                                                                  const WorldBudget& budget);

/// Returns the bytes of a file. If they are gzip-compressed, decompresses them into memory.
[[nodiscard]] BytesResult unpacked_file(const std::string& path, const SharedBytes& file, const WorldBudget& budget);
/// Decompresses gzip data. There may be several members in sequence.
[[nodiscard]] BytesResult unpacked_gzip(std::span<const std::byte> bytes, const WorldBudget& budget);
/// Decompresses zlib or gzip data to exactly `size` bytes. Ignores excess data. Returns a message if the result is
/// shorter.
[[nodiscard]] BytesResult unpacked_exactly(std::span<const std::byte> bytes, std::uint64_t size,
                                           const WorldBudget& budget);
/// Decompresses zlib or gzip data into `out`, which they must fill. Ignores excess data. Returns a message on failure.
[[nodiscard]] std::optional<std::string> unpack_into(std::span<const std::byte> bytes, std::span<std::byte> out,
                                                     const WorldBudget& budget);

/// Volume file that is being opened.
struct VolumeFile {
  std::string path, name;  // location of the file; its name at the original source
  SharedBytes content;     // decompressed content
  ReadFile read_beside;
  WorldBudget budget = own_budget();
  VoxelComponent component{};
  ReadFiles read_files = {};    // reads files of a container
  ListFolder list_folder = {};  // lists folders of a container; may be null
};
/// Loads a file that a header names, with `read_beside` (see ReadFile). Decompresses it if it is gzip-compressed.
[[nodiscard]] BytesResult load_beside(const VolumeFile& file, std::string_view name);

/// Number type of voxels in a file. 64-bit integers become f64 when read.
enum class StoredType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64, u64, i64 };
[[nodiscard]] std::size_t size_of(StoredType type);
/// Calls `f` with a value of the C++ type that corresponds to `type`.
template <class F>
decltype(auto) with_stored_type(StoredType type, F&& f) {
  return with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float,
                       double, std::uint64_t, std::int64_t>(static_cast<std::size_t>(type), f);
}

/// Voxels as stored in a file, with x as the fastest axis. Each voxel has `components` numbers, of which `component` is
/// used.
struct StoredVoxels {
  SharedBytes content;
  std::uint64_t offset = 0;  // byte offset of the first voxel
  StoredType type = StoredType::u8;
  bool big_endian = false;
  std::uint64_t components = 1;
  VoxelComponent component{};
  std::uint64_t plane = 0;  // voxels of a component if each component is contiguous; 0 if the numbers of a voxel are
};

/// Creates the source of a volume. All members of `layout` except type and big_endian must be set. Repairs the layout
/// like mend(). Magnitudes are float32. Returns a message if bytes or the component are missing, or if the layout is
/// invalid.
[[nodiscard]] VolumeResult make_source(qnv::VolumeLayout layout, StoredVoxels voxels);

/// Creates the source of a time series from consecutive volumes. If the component chooses a step, returns only that
/// step. With fewer than two times, returns make_source().
[[nodiscard]] VolumeResult make_series(const qnv::VolumeLayout& layout, const StoredVoxels& voxels,
                                       std::vector<double> times);

/// Returns the total size of all voxels in bytes, or a message if the size is too large.
[[nodiscard]] std::variant<std::uint64_t, std::string> stored_size(const qnv::VolumeLayout& layout, StoredType type,
                                                                   std::uint64_t components);

/// Parses numbers separated by blanks or commas, and stores them as voxels of a type. Uses f64 if a number does not fit
/// that type, such as 1.5 or 256 in u8. Returns a message if there are fewer than `count` numbers.
[[nodiscard]] std::variant<StoredVoxels, std::string> voxels_of_text(std::span<const std::byte> text,
                                                                     std::uint64_t count, StoredType type,
                                                                     const WorldBudget& budget);

/// Repairs the position of a volume. Axes that are not finite, zero or coplanar become unit axes. A non-finite origin
/// becomes 0, an invalid slope 1.
void mend(qnv::VolumeLayout& layout);
/// Moves the coordinates to a local origin if the volume is far from 0.
void set_base(qnv::VolumeLayout& layout);

/// Parses up to `most` numbers, separated by blanks, commas, parentheses or brackets. Stops at any other character.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text, std::size_t most);
/// Converts numbers to dimensions. Missing numbers count as 1. Returns nullopt unless all are integers from 1 to 2^32 -
/// 1.
[[nodiscard]] std::optional<std::array<std::uint32_t, 3>> dimensions_of(std::span<const double> numbers);
/// Adds a metadata pair unless its key or value is empty. Truncates both to 4096 bytes and replaces non-ASCII bytes by
/// '?'.
void add_metadata(qnv::VolumeLayout& layout, std::string_view key, std::string_view value);

/// Row of the table of formats.
struct VolumeFormat {
  VolumeFormatName name;
  bool (*sniff)(std::span<const std::byte> bytes);  // tests the first bytes; null if only the name decides
  VolumeResult (*open)(const VolumeFile& file);
  /// Returns true if a file with these first bytes can be read by parts (SharedBytes::need). Null means never.
  bool (*by_parts)(std::span<const std::byte> bytes) = nullptr;
};
/// Returns the table of formats.
[[nodiscard]] std::span<const VolumeFormat> volume_formats();
[[nodiscard]] bool is_avs_field(std::span<const std::byte> bytes);
[[nodiscard]] bool is_nrrd(std::span<const std::byte> bytes);
/// Reports whether the header of a NRRD file names a separate data file.
[[nodiscard]] bool is_detached_nrrd(std::span<const std::byte> bytes);
/// Report whether the header is complete, and uncompressed voxels follow it in the file.
[[nodiscard]] bool is_plain_nrrd(std::span<const std::byte> bytes);
[[nodiscard]] bool is_plain_meta_image(std::span<const std::byte> bytes);
[[nodiscard]] bool is_plain_nifti(std::span<const std::byte> bytes);
[[nodiscard]] bool is_meta_image(std::span<const std::byte> bytes);
[[nodiscard]] bool is_nifti(std::span<const std::byte> bytes);
[[nodiscard]] bool is_fits(std::span<const std::byte> bytes);
[[nodiscard]] bool is_slc(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vti(std::span<const std::byte> bytes);
[[nodiscard]] bool is_dicom(std::span<const std::byte> bytes);
[[nodiscard]] bool is_tiff(std::span<const std::byte> bytes);
// Files of several datasets are in app/formats/datasets.
[[nodiscard]] bool is_hdf5(std::span<const std::byte> bytes);
[[nodiscard]] bool is_classic_netcdf(std::span<const std::byte> bytes);
[[nodiscard]] bool is_xdmf(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vts(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vtr(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vtp(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vtu(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vtm(std::span<const std::byte> bytes);
[[nodiscard]] bool is_pvd(std::span<const std::byte> bytes);
[[nodiscard]] bool is_vtk_series(std::span<const std::byte> bytes);
/// Returns true if the bytes begin like a metadata file of Zarr or N5, or like a ZIP archive of Zarr.
[[nodiscard]] bool is_zarr(std::span<const std::byte> bytes);
/// Returns the path of a metadata file of Zarr or N5 in a folder of this machine, through which its container is
/// opened. Returns an empty path if the folder is no container.
[[nodiscard]] std::string zarr_entry_of_folder(const std::string& path);
[[nodiscard]] VolumeResult open_datasets(const VolumeFile& file);
/// Returns true for files that need the module for scientific formats.
[[nodiscard]] bool needs_dataset_module(std::string_view path, std::span<const std::byte> bytes);
[[nodiscard]] VolumeResult open_avs_field(const VolumeFile& file);
[[nodiscard]] VolumeResult open_nrrd(const VolumeFile& file);
[[nodiscard]] VolumeResult open_meta_image(const VolumeFile& file);
[[nodiscard]] VolumeResult open_nifti(const VolumeFile& file);
[[nodiscard]] VolumeResult open_fits(const VolumeFile& file);
[[nodiscard]] VolumeResult open_slc(const VolumeFile& file);
[[nodiscard]] VolumeResult open_vti(const VolumeFile& file);
[[nodiscard]] VolumeResult open_raw(const VolumeFile& file, const RawVolume& raw);

}  // namespace gs::app
