#include "app/formats/volume_common.h"

#include <nifti2_io.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

// NIfTI-1 and NIfTI-2 (https://nifti.nimh.nih.gov), and ANALYZE 7.5, which they grew from. The library reads
// headers only: its ways to files trust them too much.

namespace gs::app {
namespace {

template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t at, bool swap) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// What has to be known of a header before the library may have it: it prints what it does not like.
struct Head {
  int version = 1;
  bool swap = false;
  int type = 0;
  bool known_dimensions = false;
};

std::optional<Head> head_of(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 48;
  Head head;
  if (bytes.size() < sizeof(nifti_1_header)) return std::nullopt;
  const auto size = value_at<std::int32_t>(bytes, 0, false);
  if (size == static_cast<std::int32_t>(sizeof(nifti_2_header)) || size == std::int32_t{0x1c020000})
    head.version = 2;
  else if (size != static_cast<std::int32_t>(sizeof(nifti_1_header)) && size != std::int32_t{0x5c010000})
    return std::nullopt;
  head.swap = size > 0xffff;
  if (head.version == 2) {
    if (bytes.size() < sizeof(nifti_2_header)) return std::nullopt;
    const std::string_view magic = text_of(bytes).substr(offsetof(nifti_2_header, magic), 4);
    if (magic != std::string_view("n+2\0", 4) && magic != std::string_view("ni2\0", 4)) return std::nullopt;
  }
  const auto dimension = [&](std::size_t i) -> std::int64_t {
    if (head.version == 2) return value_at<std::int64_t>(bytes, offsetof(nifti_2_header, dim) + 8 * i, head.swap);
    return value_at<std::int16_t>(bytes, offsetof(nifti_1_header, dim) + 2 * i, head.swap);
  };
  head.type = value_at<std::int16_t>(
      bytes, head.version == 2 ? offsetof(nifti_2_header, datatype) : offsetof(nifti_1_header, datatype), head.swap);
  const std::int64_t count = dimension(0);
  std::uint64_t voxels = 1;
  head.known_dimensions = count >= 1 && count <= 7;
  for (std::int64_t i = 1; head.known_dimensions && i <= count; ++i) {
    const std::int64_t length = dimension(static_cast<std::size_t>(i));
    head.known_dimensions = length > 0 && static_cast<std::uint64_t>(length) <= kMostVoxels / voxels;
    if (head.known_dimensions) voxels *= static_cast<std::uint64_t>(length);
  }
  return head;
}

struct NiftiType {
  StoredType type = StoredType::u8;
  std::uint64_t components = 1;
};

std::optional<NiftiType> type_of(int code) {
  switch (code) {
    case DT_UINT8:
      return NiftiType{StoredType::u8};
    case DT_INT8:
      return NiftiType{StoredType::i8};
    case DT_INT16:
      return NiftiType{StoredType::i16};
    case DT_UINT16:
      return NiftiType{StoredType::u16};
    case DT_INT32:
      return NiftiType{StoredType::i32};
    case DT_UINT32:
      return NiftiType{StoredType::u32};
    case DT_INT64:
      return NiftiType{StoredType::i64};
    case DT_UINT64:
      return NiftiType{StoredType::u64};
    case DT_FLOAT32:
      return NiftiType{StoredType::f32};
    case DT_FLOAT64:
      return NiftiType{StoredType::f64};
    case DT_COMPLEX64:
      return NiftiType{StoredType::f32, 2};
    case DT_RGB24:
      return NiftiType{StoredType::u8, 3};
    case DT_RGBA32:
      return NiftiType{StoredType::u8, 4};
    default:
      return std::nullopt;
  }
}

using Image = std::unique_ptr<nifti_image, decltype(&nifti_image_free)>;

Image image_of(std::span<const std::byte> bytes, const Head& head) {
  static const bool silent = [] {
    nifti_set_debug_level(0);
    return true;
  }();
  (void)silent;
  if (head.version == 2) {
    nifti_2_header header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    return {nifti_convert_n2hdr2nim(header, nullptr), nifti_image_free};
  }
  nifti_1_header header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  return {nifti_convert_n1hdr2nim(header, nullptr), nifti_image_free};
}

template <std::size_t n>
std::string_view text_field(const char (&text)[n]) {
  return {text, std::find(text, text + n, '\0')};
}

void place(const nifti_image& image, qnv::VolumeLayout& layout) {
  // Method 3 where the file has it, else method 2, else 1 (nifti1.h, "3D image orientation").
  const nifti_dmat44& matrix = image.sform_code > 0 ? image.sto_xyz : image.qto_xyz;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) layout.axes[static_cast<std::size_t>(axis)][i] = static_cast<float>(matrix.m[i][axis]);
  for (int i = 0; i < 3; ++i) layout.origin[i] = static_cast<float>(matrix.m[i][3]);
  qnv::VolumeLayout mended = layout;
  mend(mended);
  if (mended.axes == layout.axes) return;
  const std::array<double, 3> steps = {image.dx, image.dy, image.dz};
  for (std::size_t i = 0; i < 3; ++i)
    layout.axes[i] = qnv::VolumeLayout{}.axes[i] * static_cast<float>(steps[i] > 0 && steps[i] < 1e15 ? steps[i] : 1);
}

void describe(const nifti_image& image, qnv::VolumeLayout& layout) {
  add_metadata(layout, "title", text_field(image.intent_name));
  add_metadata(layout, "description", text_field(image.descrip));
  if (image.xyz_units == NIFTI_UNITS_METER) add_metadata(layout, "space units", "m");
  if (image.xyz_units == NIFTI_UNITS_MM) add_metadata(layout, "space units", "mm");
  if (image.xyz_units == NIFTI_UNITS_MICRON) add_metadata(layout, "space units", "um");
}

/// The file that belongs to this one: "a.img.gz" and ".hdr" give "a.hdr" or "a.hdr.gz".
BytesResult load_partner(const VolumeFile& file, std::string_view extension) {
  std::string name = file.path.substr(file.path.rfind('/') + 1);  // npos + 1 is 0
  if (lower_case(name).ends_with(".gz")) name.resize(name.size() - 3);
  name.resize(std::min(name.size(), name.rfind('.')));
  BytesResult loaded = load_beside(file, name + std::string(extension));
  if (std::holds_alternative<SharedBytes>(loaded)) return loaded;
  BytesResult packed = load_beside(file, name + std::string(extension) + ".gz");
  return std::holds_alternative<SharedBytes>(packed) ? packed : loaded;
}

}  // namespace

bool is_nifti(std::span<const std::byte> bytes) {
  const std::optional<Head> head = head_of(bytes);
  return head && head->known_dimensions;
}

VolumeResult open_nifti(const VolumeFile& file) {
  SharedBytes header = file.content;
  std::string name = lower_case(file.path);
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  if (name.ends_with(".img") && !is_nifti(header.bytes)) {
    BytesResult loaded = load_partner(file, ".hdr");
    if (const auto* problem = std::get_if<std::string>(&loaded)) return "its header: " + *problem;
    header = std::get<SharedBytes>(std::move(loaded));
  }
  const std::optional<Head> head = head_of(header.bytes);
  if (!head) return std::string("no header of 348 (NIfTI-1, ANALYZE) or 540 bytes (NIfTI-2) stands at its begin");
  if (!head->known_dimensions) return std::string("the dimensions are wrong; expected 1 to 7 counts from 1 on");
  const std::optional<NiftiType> type = type_of(head->type);
  if (!type)
    return "the data type is " + std::to_string(head->type) + "; expected integers, floats or RGB of 8 to 64 bits";
  const Image image = image_of(header.bytes, *head);
  if (!image) return std::string("the header is damaged");

  qnv::VolumeLayout layout;
  const std::array<double, 3> sizes = {static_cast<double>(image->nx), static_cast<double>(image->ny),
                                       static_cast<double>(image->nz)};
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return std::string("the dimensions are wrong; expected whole numbers from 1 on");
  layout.dimensions = *dimensions;
  place(*image, layout);
  if (std::isfinite(image->scl_slope) && image->scl_slope != 0) {
    layout.slope = image->scl_slope;
    layout.intercept = image->scl_inter;
  }
  describe(*image, layout);

  StoredVoxels voxels;
  voxels.content = header;
  voxels.type = type->type;
  voxels.components = type->components;
  voxels.big_endian = head->swap != (std::endian::native == std::endian::big);  // as the header
  const bool one_file = image->nifti_type == NIFTI_FTYPE_NIFTI1_1 || image->nifti_type == NIFTI_FTYPE_NIFTI2_1;
  if (!one_file) {
    BytesResult loaded = load_partner(file, ".img");
    if (const auto* problem = std::get_if<std::string>(&loaded)) return "its voxels: " + *problem;
    voxels.content = std::get<SharedBytes>(std::move(loaded));
  }
  if (image->iname_offset < 0) return std::string("the offset of the voxels is negative");
  voxels.offset = static_cast<std::uint64_t>(image->iname_offset);
  return make_source(std::move(layout), std::move(voxels));
}

}  // namespace gs::app
