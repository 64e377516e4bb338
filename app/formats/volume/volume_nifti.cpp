#include "app/formats/volume/volume_common.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

// Reader of NIfTI-1, NIfTI-2 (https://nifti.nimh.nih.gov) and their predecessor ANALYZE 7.5. Quoted titles refer to
// comments in nifti1.h.

namespace gs::app {
namespace {

constexpr std::size_t kNifti1Bytes = 348, kNifti2Bytes = 540;

template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t at, bool swap) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// Location of a field in both header versions. They differ in the order and sizes of fields.
struct NiftiField {
  std::size_t first, second;
};
constexpr NiftiField kMagic{344, 4}, kDimensions{40, 16}, kDataType{70, 12}, kNiftiSteps{76, 104},
    kVoxelOffset{108, 168}, kSlope{112, 176}, kIntercept{116, 184}, kUnits{123, 500}, kDescription{148, 240},
    kQuaternionCode{252, 344}, kMatrixCode{254, 348}, kQuaternion{256, 352}, kOffset{268, 376}, kMatrix{280, 400},
    kIntent{328, 508}, kIntentCode{68, 504}, kTimeOffset{136, 216};

constexpr int kLabelIntent = 1002;  // NIFTI_INTENT_LABEL

/// Header that was completely read.
class NiftiHeader {
 public:
  /// Reads a header. Returns nullopt if the bytes do not begin with one.
  static std::optional<NiftiHeader> read(std::span<const std::byte> bytes) {
    if (bytes.size() < kNifti1Bytes) return std::nullopt;
    const auto size = value_at<std::int32_t>(bytes, 0, false);
    NiftiHeader header(bytes);
    header.swap_ = size > 0xffff;
    const std::int32_t own = header.swap_ ? value_at<std::int32_t>(bytes, 0, true) : size;
    if (own != std::int32_t{kNifti1Bytes} && own != std::int32_t{kNifti2Bytes}) return std::nullopt;
    header.second_ = own == std::int32_t{kNifti2Bytes};
    if (header.second_ && bytes.size() < kNifti2Bytes) return std::nullopt;
    const std::string_view magic = text_of(bytes).substr(header.at(kMagic), 4);
    const char version = header.second_ ? '2' : '1';
    header.one_file_ = magic == std::string{'n', '+', version, '\0'};
    header.nifti_ = header.one_file_ || magic == std::string{'n', 'i', version, '\0'};
    if (header.second_ && !header.nifti_) return std::nullopt;
    return header;
  }

  [[nodiscard]] bool big_endian() const { return swap_ != (std::endian::native == std::endian::big); }
  [[nodiscard]] bool is_nifti() const { return nifti_; }  // false for ANALYZE, which has only sizes and steps
  [[nodiscard]] bool one_file() const { return one_file_; }
  [[nodiscard]] std::size_t size() const { return second_ ? kNifti2Bytes : kNifti1Bytes; }

  [[nodiscard]] std::int64_t dimension(std::size_t i) const {
    if (second_) return value_at<std::int64_t>(bytes_, kDimensions.second + 8 * i, swap_);
    return value_at<std::int16_t>(bytes_, kDimensions.first + 2 * i, swap_);
  }
  [[nodiscard]] int data_type() const { return value_at<std::int16_t>(bytes_, at(kDataType), swap_); }
  [[nodiscard]] int code(NiftiField field) const {
    if (second_) return value_at<std::int32_t>(bytes_, field.second, swap_);
    return value_at<std::int16_t>(bytes_, field.first, swap_);
  }
  /// Returns element `i` of a field.
  [[nodiscard]] double real(NiftiField field, std::size_t i = 0) const {
    if (second_) return value_at<double>(bytes_, field.second + 8 * i, swap_);
    return double{value_at<float>(bytes_, field.first + 4 * i, swap_)};
  }
  /// Returns element `i` of a field, or 0 if that number is not finite.
  [[nodiscard]] double number(NiftiField field, std::size_t i = 0) const {
    const double value = real(field, i);
    return std::isfinite(value) ? value : 0;
  }
  /// Returns the voxel step along an axis, 0 to 2.
  [[nodiscard]] double step(std::size_t axis) const {
    const double step = number(kNiftiSteps, axis + 1);
    return step == 0 ? 1 : step;
  }
  [[nodiscard]] std::string_view text(NiftiField field, std::size_t most) const {
    const std::string_view all = text_of(bytes_).substr(at(field), most);
    return all.substr(0, all.find('\0'));
  }
  [[nodiscard]] int space_units() const { return units() & 7; }
  /// Returns the unit of times: 1 for seconds, 2 for milliseconds, 3 for microseconds.
  [[nodiscard]] int time_units() const { return units() >> 3 & 7; }
  /// Returns the offset of the voxels in their file, which may be a separate file. Negative if the offset is invalid.
  [[nodiscard]] std::int64_t voxel_offset() const {
    constexpr double kMax = 1e15;
    const double real = second_ ? 0 : number(kVoxelOffset);
    if (!(real > -kMax && real < kMax)) return -1;
    const std::int64_t offset =
        second_ ? value_at<std::int64_t>(bytes_, kVoxelOffset.second, swap_) : static_cast<std::int64_t>(real);
    return one_file_ ? std::max(offset, static_cast<std::int64_t>(size())) : offset;
  }

  /// Returns true if the header has 1 to 7 positive lengths and a plausible number of voxels.
  [[nodiscard]] bool known_dimensions() const {
    constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 48;
    const std::int64_t count = dimension(0);
    if (count < 1 || count > 7) return false;
    std::uint64_t voxels = 1;
    for (std::int64_t i = 1; i <= count; ++i) {
      const std::int64_t length = dimension(static_cast<std::size_t>(i));
      if (length <= 0 || static_cast<std::uint64_t>(length) > kMaxVoxels / voxels) return false;
      voxels *= static_cast<std::uint64_t>(length);
    }
    return true;
  }

 private:
  [[nodiscard]] int units() const {
    return second_ ? value_at<std::int32_t>(bytes_, kUnits.second, swap_) : std::to_integer<int>(bytes_[kUnits.first]);
  }
  explicit NiftiHeader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::size_t at(NiftiField field) const { return second_ ? field.second : field.first; }

  std::span<const std::byte> bytes_;
  bool swap_ = false, second_ = false, nifti_ = false, one_file_ = false;
};

struct NiftiType {
  StoredType type = StoredType::u8;
  std::uint64_t components = 1;
};

std::optional<NiftiType> nifti_type_of(int code) {
  // DT_UINT8, DT_INT16, DT_INT32, DT_FLOAT32, DT_COMPLEX64, DT_FLOAT64, DT_RGB24, DT_INT8, DT_UINT16, DT_UINT32,
  // DT_INT64, DT_UINT64, DT_RGBA32
  static constexpr std::pair<int, NiftiType> kTypes[] = {
      {2, {StoredType::u8}},      {4, {StoredType::i16}},   {8, {StoredType::i32}},     {16, {StoredType::f32}},
      {32, {StoredType::f32, 2}}, {64, {StoredType::f64}},  {128, {StoredType::u8, 3}}, {256, {StoredType::i8}},
      {512, {StoredType::u16}},   {768, {StoredType::u32}}, {1024, {StoredType::i64}},  {1280, {StoredType::u64}},
      {2304, {StoredType::u8, 4}}};
  for (const auto& [type_code, type] : kTypes)
    if (type_code == code) return type;
  return std::nullopt;
}

/// Matrix of 3 rows: the steps along the three axes, then the origin.
using NiftiMatrix = std::array<std::array<double, 4>, 3>;

/// Returns the matrix of method 2 ("quaternion representation of rotation matrix"). The header has b, c, d of a unit
/// quaternion, and a flag that mirrors z.
NiftiMatrix quaternion_matrix(const NiftiHeader& header) {
  double b = header.number(kQuaternion, 0), c = header.number(kQuaternion, 1), d = header.number(kQuaternion, 2);
  const double rest = 1 - (b * b + c * c + d * d);
  constexpr double kMin = 1e-7;  // below this, b, c, d give half a turn whatever their length
  double a = 0;
  if (rest >= kMin) {
    a = std::sqrt(rest);
  } else {
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length, c /= length, d /= length;
  }
  const auto positive = [&](std::size_t axis) { return header.step(axis) > 0 ? header.step(axis) : 1; };
  const double x = positive(0), y = positive(1), z = positive(2) * (header.number(kNiftiSteps, 0) < 0 ? -1 : 1);
  return {{{(a * a + b * b - c * c - d * d) * x, 2 * (b * c - a * d) * y, 2 * (b * d + a * c) * z,
            header.number(kOffset, 0)},
           {2 * (b * c + a * d) * x, (a * a + c * c - b * b - d * d) * y, 2 * (c * d - a * b) * z,
            header.number(kOffset, 1)},
           {2 * (b * d - a * c) * x, 2 * (c * d + a * b) * y, (a * a + d * d - c * c - b * b) * z,
            header.number(kOffset, 2)}}};
}

/// Returns the matrix of the best method that the header has: 3, else 2, else 1 ("3D image orientation").
NiftiMatrix matrix_of(const NiftiHeader& header) {
  if (header.is_nifti() && header.code(kMatrixCode) > 0) {
    NiftiMatrix matrix{};
    for (std::size_t i = 0; i < 12; ++i) matrix[i / 4][i % 4] = header.real(kMatrix, i);
    return matrix;
  }
  if (header.is_nifti() && header.code(kQuaternionCode) > 0) return quaternion_matrix(header);
  NiftiMatrix matrix{};
  for (std::size_t i = 0; i < 3; ++i) matrix[i][i] = header.step(i);
  return matrix;
}

void place(const NiftiHeader& header, qnv::VolumeLayout& layout) {
  const NiftiMatrix matrix = matrix_of(header);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<int>(i);
    for (std::size_t axis = 0; axis < 3; ++axis) layout.axes[axis][row] = static_cast<float>(matrix[i][axis]);
    layout.origin[row] = matrix[i][3];
  }
  qnv::VolumeLayout mended = layout;
  mend(mended);
  if (mended.axes == layout.axes) return;
  for (std::size_t i = 0; i < 3; ++i) {
    const double step = header.step(i);
    layout.axes[i] = qnv::VolumeLayout{}.axes[i] * static_cast<float>(step > 0 && step < 1e15 ? step : 1);
  }
}

void describe(const NiftiHeader& header, qnv::VolumeLayout& layout) {
  if (header.is_nifti()) add_metadata(layout, "title", header.text(kIntent, 15));
  add_metadata(layout, "description", header.text(kDescription, 79));
  static constexpr const char* kSpaceUnits[] = {"", "m", "mm", "um"};
  if (header.is_nifti() && header.space_units() <= 3)
    add_metadata(layout, "space units", kSpaceUnits[header.space_units()]);
}

/// Returns the times of the steps along the fourth axis; empty without steps.
std::vector<double> times_of(const NiftiHeader& header) {
  if (!header.is_nifti() || header.dimension(0) < 4) return {};
  const std::int64_t count = header.dimension(4);
  if (count < 2 || count > static_cast<std::int64_t>(qnv::kMaxSteps)) return {};
  const double given = header.number(kNiftiSteps, 4), apart = given > 0 ? given : 1, first = header.number(kTimeOffset);
  std::vector<double> times;
  for (std::int64_t i = 0; i < count; ++i) times.push_back(first + apart * static_cast<double>(i));
  return times;
}

/// Loads the other file of a pair. For "a.img.gz" and extension ".hdr", that is "a.hdr" or "a.hdr.gz".
BytesResult load_partner(const VolumeFile& file, std::string_view extension) {
  std::string name = file.name;
  if (lower_case(name).ends_with(".gz")) name.resize(name.size() - 3);
  name.resize(std::min(name.size(), name.rfind('.')));
  BytesResult loaded = load_beside(file, name + std::string(extension));
  if (std::holds_alternative<SharedBytes>(loaded)) return loaded;
  BytesResult packed = load_beside(file, name + std::string(extension) + ".gz");
  return std::holds_alternative<SharedBytes>(packed) ? packed : loaded;
}

}  // namespace

bool is_nifti(std::span<const std::byte> bytes) {
  const auto header = NiftiHeader::read(bytes);
  return header && header->known_dimensions();
}

bool is_plain_nifti(std::span<const std::byte> bytes) {
  const auto header = NiftiHeader::read(bytes);
  return header && header->known_dimensions() && header->one_file();
}

VolumeResult open_nifti(const VolumeFile& file) {
  SharedBytes bytes = file.content;
  std::string name = lower_case(file.path);
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  if (name.ends_with(".img") && !is_nifti(bytes.bytes)) {
    BytesResult loaded = load_partner(file, ".hdr");
    if (const auto* problem = std::get_if<std::string>(&loaded)) return "its header: " + *problem;
    bytes = std::get<SharedBytes>(std::move(loaded));
  }
  const auto header = NiftiHeader::read(bytes.bytes);
  if (!header) return std::string("no header of 348 (NIfTI-1, ANALYZE) or 540 bytes (NIfTI-2) at its start");
  if (!header->known_dimensions()) return std::string("the dimensions are invalid; expected 1 to 7 numbers above 0");
  const std::optional<NiftiType> type = nifti_type_of(header->data_type());
  if (!type)
    return "the data type is " + std::to_string(header->data_type()) +
           "; expected integers, floats or RGB of 8 to 64 bits";

  qnv::VolumeLayout layout;
  std::array<double, 3> sizes{1, 1, 1};
  for (std::size_t i = 0; i < 3 && static_cast<std::int64_t>(i) < header->dimension(0); ++i)
    sizes[i] = static_cast<double>(header->dimension(i + 1));
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return std::string("the dimensions are invalid; expected whole numbers above 0");
  layout.dimensions = *dimensions;
  place(*header, layout);
  if (header->is_nifti() && header->number(kSlope) != 0) {
    layout.slope = header->number(kSlope);
    layout.intercept = header->number(kIntercept);
  }
  describe(*header, layout);
  layout.labels = header->is_nifti() && header->code(kIntentCode) == kLabelIntent;

  StoredVoxels voxels;
  voxels.content = bytes;
  voxels.type = type->type;
  voxels.components = type->components;
  voxels.component = file.component;
  voxels.big_endian = header->big_endian();
  layout.colors = type->components > 2;  // DT_RGB24, DT_RGBA32
  // "The 5th dimension is vector-valued data"; the numbers of a voxel are a whole volume apart.
  std::vector<double> times = times_of(*header);
  const std::int64_t numbers =
      header->dimension(0) >= 5 && (header->dimension(4) == 1 || !times.empty()) ? header->dimension(5) : 1;
  if (numbers > 1 && numbers <= qnv::kMaxValueComponents && voxels.components == 1) {
    voxels.components = static_cast<std::uint64_t>(numbers);
    voxels.plane = qnv::voxel_count(layout) * std::max<std::uint64_t>(times.size(), 1);
  }
  if (!header->one_file()) {
    BytesResult loaded = load_partner(file, ".img");
    if (const auto* problem = std::get_if<std::string>(&loaded)) return "its voxels: " + *problem;
    voxels.content = std::get<SharedBytes>(std::move(loaded));
  }
  if (header->voxel_offset() < 0) return std::string("the offset of the voxels is negative");
  voxels.offset = static_cast<std::uint64_t>(header->voxel_offset());
  static constexpr const char* kTimeUnits[] = {"", "s", "ms", "us"};
  if (!times.empty() && header->time_units() <= 3) add_metadata(layout, "time unit", kTimeUnits[header->time_units()]);
  return make_series(layout, voxels, std::move(times));
}

}  // namespace gs::app
