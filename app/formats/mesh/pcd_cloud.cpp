#include "app/formats/mesh/pcd_cloud.h"

#include "app/formats/common/text_cursor.h"
#include "base/text.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostPcdFields = 256, kMostPcdCount = 4096;
constexpr std::uint64_t kMostPcdPoints = std::uint64_t{1} << 32;

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  TextCursor cursor(line.data(), line.data() + line.size());
  for (std::string_view word = cursor.word(); !word.empty() && words.size() <= kMostPcdFields; word = cursor.word())
    words.emplace_back(word);
  return words;
}

std::uint64_t whole_number(const std::vector<std::string>& words, std::uint64_t otherwise) {
  const std::vector<double> numbers = words.size() < 2 ? std::vector<double>() : numbers_of(words[1], 1);
  return numbers.empty() || !(numbers[0] >= 0 && numbers[0] < 1e15) ? otherwise
                                                                    : static_cast<std::uint64_t>(numbers[0]);
}

bool is_pcd_type(const PcdField& field) {
  if (field.type == 'F') return field.size == 4 || field.size == 8;
  return (field.type == 'I' || field.type == 'U') && std::has_single_bit(field.size) && field.size <= 8;
}

StoredType stored_type_of(const PcdField& field) {
  if (field.type == 'F') return field.size == 8 ? StoredType::f64 : StoredType::f32;
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? StoredType::i8 : StoredType::u8;
    case 2:
      return is_signed ? StoredType::i16 : StoredType::u16;
    case 4:
      return is_signed ? StoredType::i32 : StoredType::u32;
    default:
      return is_signed ? StoredType::i64 : StoredType::u64;
  }
}

glm::dmat3 turn_of(double w, double x, double y, double z) {
  const double square = w * w + x * x + y * y + z * z;
  if (!std::isnormal(square)) return glm::dmat3(1);
  const double s = 2 / square;
  return {glm::dvec3(1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
          glm::dvec3(s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)),
          glm::dvec3(s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y))};
}

}  // namespace

bool unpack_lzf(std::span<const std::byte> from, std::span<std::byte> to) {
  std::size_t in = 0, out = 0;
  const auto next = [&] { return std::to_integer<std::size_t>(from[in++]); };
  while (in < from.size()) {
    const std::size_t control = next();
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > from.size() - in || count > to.size() - out) return false;
      std::memcpy(to.data() + out, from.data() + in, count);
      in += count;
      out += count;
      continue;
    }
    std::size_t count = control >> 5;
    if (count == 7) {
      if (in >= from.size()) return false;
      count += next();
    }
    count += 2;
    if (in >= from.size()) return false;
    const std::size_t back = ((control & 31) << 8 | next()) + 1;
    if (back > out || count > to.size() - out) return false;
    for (std::size_t i = 0; i < count; ++i, ++out) to[out] = to[out - back];  // the parts may overlap
  }
  return out == to.size();
}

bool PcdCloud::read_header(std::span<const std::byte> bytes) {
  TextCursor cursor(bytes);
  const char* const begin = cursor.next;
  constexpr int kMostLines = 1000;
  std::vector<double> pose;
  for (int line = 0; line < kMostLines && !cursor.at_end(); ++line) {
    const std::vector<std::string> words = words_of(cursor.line());
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string& key = words[0];
    const std::size_t count = std::min(words.size() - 1, kMostPcdFields);
    if (key == "FIELDS" || key == "COLUMNS") {
      fields_.assign(count, {});
      for (std::size_t i = 0; i < count; ++i) fields_[i].name = lower_case(words[i + 1]);
    } else if (key == "SIZE" || key == "COUNT") {
      for (std::size_t i = 0; i < std::min(count, fields_.size()); ++i) {
        const std::vector<double> number = numbers_of(words[i + 1], 1);
        if (number.empty() || !(number[0] >= 1 && number[0] <= static_cast<double>(kMostPcdCount))) return false;
        (key == "SIZE" ? fields_[i].size : fields_[i].count) = static_cast<std::size_t>(number[0]);
      }
    } else if (key == "TYPE") {
      for (std::size_t i = 0; i < std::min(count, fields_.size()); ++i) fields_[i].type = words[i + 1][0];
    } else if (key == "WIDTH") {
      width_ = whole_number(words, 0);
    } else if (key == "HEIGHT") {
      height_ = whole_number(words, 1);
    } else if (key == "VIEWPOINT") {
      for (std::size_t i = 0; i < count; ++i)
        for (const double number : numbers_of(words[i + 1], 1)) pose.push_back(number);
    } else if (key == "POINTS") {
      announced_ = whole_number(words, 0);
    } else if (key == "DATA") {
      const std::string form = words.size() > 1 ? lower_case(words[1]) : std::string();
      if (form != "ascii" && form != "binary" && form != "binary_compressed") return false;
      form_ = form == "ascii" ? Form::text : form == "binary" ? Form::binary : Form::compressed;
      data_ = static_cast<std::size_t>(cursor.next - begin);
      break;
    }
  }
  if (announced_ == 0 && width_ < kMostPcdPoints && height_ < kMostPcdPoints) announced_ = width_ * height_;
  if (data_ == 0 || fields_.empty() || announced_ > kMostPcdPoints) return false;
  for (PcdField& one : fields_) {
    if (!is_pcd_type(one)) return false;
    one.offset = point_bytes_;
    one.column = columns_;
    point_bytes_ += one.size * one.count;
    columns_ += one.count;
  }
  const bool posed = pose.size() == 7 && std::ranges::all_of(pose, [](double one) { return std::isfinite(one); }) &&
                     pose != std::vector<double>{0, 0, 0, 1, 0, 0, 0};
  if (posed) {
    shift_ = {pose[0], pose[1], pose[2]};
    turn_ = turn_of(pose[3], pose[4], pose[5], pose[6]);
  } else if (height_ > 1) {
    turn_ = {glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, -1)};
  }
  return true;
}

std::variant<PcdCloud, std::string> PcdCloud::open(std::span<const std::byte> bytes, const WorldBudget& budget) {
  PcdCloud cloud;
  if (!cloud.read_header(bytes))
    return std::string("PCD: the header is damaged; expected FIELDS, SIZE, TYPE, COUNT, WIDTH, POINTS and DATA");
  std::size_t number = 0;
  for (const char* const axis : {"x", "y", "z"}) {
    const PcdField* const field = cloud.field(axis);
    if (!field) return std::string("PCD: expected the fields x, y and z");
    cloud.axes_[number++] = static_cast<std::size_t>(field - cloud.fields_.data());
  }
  if (std::string problem = cloud.read_points(bytes.subspan(cloud.data_), budget); !problem.empty())
    return "PCD: " + problem;
  return cloud;
}

std::string PcdCloud::read_points(std::span<const std::byte> bytes, const WorldBudget& budget) {
  share_ = Share(budget, Resource::vectors);
  const auto most = static_cast<std::size_t>(announced_);
  if (form_ == Form::text) return read_text(bytes, budget);
  if (form_ == Form::compressed) return unpack(bytes, budget);
  stored_ = bytes;
  rows_ = std::min(most, bytes.size() / point_bytes_);
  return {};
}

std::string PcdCloud::read_text(std::span<const std::byte> bytes, const WorldBudget& budget) {
  TextCursor cursor(bytes);
  while (rows_ < announced_ && cursor.skip_space()) {
    constexpr std::size_t kStep = 4096;
    if (rows_ % kStep == 0 && !share_.grow(kStep * columns_ * sizeof(double)))
      return "the points take " + budget->refusal(Resource::vectors);
    for (std::size_t i = 0; i < columns_; ++i) {
      double value = 0;
      if (!cursor.skip_space() || !cursor.number(value)) {
        numbers_.resize(rows_ * columns_);
        return cursor.at_end() ? std::string() : "point " + std::to_string(rows_) + ": expected a number";
      }
      numbers_.push_back(value);
    }
    ++rows_;
  }
  return {};
}

std::string PcdCloud::unpack(std::span<const std::byte> bytes, const WorldBudget& budget) {
  constexpr std::size_t kSizes = 8;
  constexpr std::uint64_t kMostExpansion = 132;  // upper bound: LZF expands three bytes to at most 264
  if (bytes.size() < kSizes) return "the compressed points are truncated";
  std::array<std::uint32_t, 2> sizes{};
  std::memcpy(sizes.data(), bytes.data(), kSizes);
  bytes = bytes.subspan(kSizes);
  if (sizes[0] > bytes.size())
    return "the compressed points are truncated: " + std::to_string(bytes.size()) + " bytes; expected " +
           std::to_string(sizes[0]);
  if (sizes[1] > std::uint64_t{sizes[0]} * kMostExpansion || sizes[1] / point_bytes_ < announced_)
    return "the size of the compressed points is damaged";
  if (!share_.grow(sizes[1])) return "the points take " + budget->refusal(Resource::vectors);
  unpacked_.resize(sizes[1]);
  if (!unpack_lzf(bytes.first(sizes[0]), unpacked_)) return "the compressed points are damaged";
  rows_ = static_cast<std::size_t>(announced_);
  return {};
}

const PcdField* PcdCloud::field(std::string_view name) const {
  const auto found = std::ranges::find(fields_, name, &PcdField::name);
  return found == fields_.end() ? nullptr : &*found;
}

// In compressed files, all numbers of a field come together.
const std::byte* PcdCloud::place(const PcdField& field, std::size_t row) const {
  return form_ == Form::compressed ? unpacked_.data() + field.offset * rows_ + row * field.size * field.count
                                   : stored_.data() + row * point_bytes_ + field.offset;
}

double PcdCloud::number(const PcdField& field, std::size_t row) const {
  if (form_ == Form::text) return numbers_[row * columns_ + field.column];
  return with_stored_type(stored_type_of(field), [&](auto kind) {
    decltype(kind) value{};
    std::memcpy(&value, place(field, row), sizeof value);
    return static_cast<double>(value);
  });
}

std::uint32_t PcdCloud::packed(const PcdField& field, std::size_t row) const {
  if (form_ != Form::text) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, place(field, row), std::min(field.size, sizeof bits));
    return bits;
  }
  const double value = number(field, row);
  if (field.type == 'F') return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  return value >= 0 && value <= std::numeric_limits<std::uint32_t>::max() ? static_cast<std::uint32_t>(value) : 0;
}

glm::dvec3 PcdCloud::position(std::size_t row) const {
  glm::dvec3 point(0);
  for (int axis = 0; axis < 3; ++axis) point[axis] = number(fields_[axes_[static_cast<std::size_t>(axis)]], row);
  return turn_ * point + shift_;
}

}  // namespace gs::app
