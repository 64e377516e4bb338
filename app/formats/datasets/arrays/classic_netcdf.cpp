#include "app/formats/datasets/arrays/classic_netcdf.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

// Reader of the NetCDF classic formats: https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html

namespace gs::app {
namespace {

constexpr std::uint32_t kDimensionTag = 10, kVariableTag = 11, kAttributeTag = 12, kCharType = 2;
constexpr std::size_t kMostClassicItems = 1 << 20, kMostClassicNumbers = 1 << 16, kMostClassicAxes = 64;

/// Thrown for a header that is truncated or impossible.
struct BadHeader {
  const char* message;
};

struct ClassicType {
  NumberType type;
  const char* name;
};
// Types by their numbers in the file.
constexpr ClassicType kClassicTypes[] = {
    {NumberType::none, "none"}, {NumberType::i8, "i8"},     {NumberType::none, "text"}, {NumberType::i16, "i16be"},
    {NumberType::i32, "i32be"}, {NumberType::f32, "f32be"}, {NumberType::f64, "f64be"}, {NumberType::u8, "u8"},
    {NumberType::u16, "u16be"}, {NumberType::u32, "u32be"}, {NumberType::i64, "i64be"}, {NumberType::u64, "u64be"}};

std::size_t bytes_of(std::uint32_t type) { return type == kCharType ? 1 : size_of(kClassicTypes[type].type); }

/// Copies numbers from big endian to native order.
void copy_native(const std::byte* from, std::size_t size, std::size_t count, std::byte* to) {
  if (size == 1 || std::endian::native == std::endian::big) {
    std::memcpy(to, from, size * count);
    return;
  }
  for (std::size_t i = 0; i < count; ++i, from += size, to += size)
    for (std::size_t k = 0; k < size; ++k) to[k] = from[size - 1 - k];
}

double number_at(const std::byte* from, NumberType type) {
  std::byte native[8]{};
  copy_native(from, size_of(type), 1, native);
  const auto as = [&]<class T>(T) {
    T value{};
    std::memcpy(&value, native, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case NumberType::u8:
      return as(std::uint8_t{});
    case NumberType::i8:
      return as(std::int8_t{});
    case NumberType::u16:
      return as(std::uint16_t{});
    case NumberType::i16:
      return as(std::int16_t{});
    case NumberType::u32:
      return as(std::uint32_t{});
    case NumberType::i32:
      return as(std::int32_t{});
    case NumberType::f32:
      return as(float{});
    case NumberType::u64:
      return as(std::uint64_t{});
    case NumberType::i64:
      return as(std::int64_t{});
    default:
      return as(double{});
  }
}

/// Position in a header.
class HeaderCursor {
 public:
  HeaderCursor(const ArrayBytes& file, int version) : file_(file), bytes_(file.bytes), version_(version), at_(4) {}

  std::span<const std::byte> take(std::uint64_t count) {
    if (count > bytes_.size() - at_) throw BadHeader{"the header is truncated"};
    if (!have_bytes(file_.need, at_, count)) throw BadHeader{"the header cannot be received"};
    const auto part = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return part;
  }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (const std::byte byte : take(4)) value = value << 8 | std::to_integer<std::uint32_t>(byte);
    return value;
  }
  std::uint64_t wide() { return std::uint64_t{word()} << 32 | word(); }
  /// Reads a count, which has 8 bytes in CDF-5.
  std::uint64_t count() { return version_ == 5 ? wide() : word(); }
  std::uint64_t offset() { return version_ == 1 ? word() : wide(); }
  /// Reads a count of items of at least `bytes` bytes each.
  std::size_t items(std::size_t bytes) {
    const std::uint64_t number = count();
    if (number > kMostClassicItems || number > (bytes_.size() - at_) / bytes)
      throw BadHeader{"the header states more items than it has"};
    return static_cast<std::size_t>(number);
  }
  std::string name() {
    const std::size_t length = items(1);
    const auto text = take(length);
    skip_padding(length);
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  void skip_padding(std::uint64_t length) { (void)take((4 - length % 4) % 4); }
  /// Reads the tag and the count of a list.
  std::size_t list(std::uint32_t tag, std::size_t bytes) {
    const std::uint32_t found = word();
    const std::size_t number = items(bytes);
    if (found != tag && (found != 0 || number != 0)) throw BadHeader{"the header is damaged"};
    return number;
  }
  std::uint32_t type() {
    const std::uint32_t found = word();
    if (found == 0 || found >= std::size(kClassicTypes)) throw BadHeader{"the header has an unknown type"};
    return found;
  }
  std::vector<ArrayAttribute> attributes() {
    std::vector<ArrayAttribute> all(list(kAttributeTag, 12));
    for (ArrayAttribute& one : all) {
      one.name = name();
      const std::uint32_t kind = type();
      const std::size_t size = bytes_of(kind), number = items(size);
      const auto values = take(std::uint64_t{number} * size);
      skip_padding(values.size());
      if (kind == kCharType) {
        const std::string_view text(reinterpret_cast<const char*>(values.data()), values.size());
        one.texts.emplace_back(text.substr(0, text.find('\0')));
      } else {
        for (std::size_t i = 0; i < std::min(number, kMostClassicNumbers); ++i)
          one.numbers.push_back(number_at(values.data() + i * size, kClassicTypes[kind].type));
      }
    }
    return all;
  }

 private:
  const ArrayBytes& file_;
  std::span<const std::byte> bytes_;
  int version_;
  std::size_t at_;
};

/// Place of the values of a variable.
struct ClassicPlace {
  std::uint64_t begin = 0;
  bool records = false;  // the first axis is that of the records
};

class ClassicFile final : public ArrayFile {
 public:
  explicit ClassicFile(ArrayBytes bytes) : bytes_(std::move(bytes)) {}

  void read_header() {
    const int version = std::to_integer<int>(bytes_.bytes[3]);
    HeaderCursor cursor(bytes_, version);
    std::uint64_t records = cursor.count();
    const bool streaming = records == (version == 5 ? std::numeric_limits<std::uint64_t>::max() : 0xffffffff);
    struct Axis {
      std::string name;
      std::uint64_t length = 0;
    };
    std::vector<Axis> axes(cursor.list(kDimensionTag, 8));
    for (Axis& axis : axes) {
      axis.name = cursor.name();
      axis.length = cursor.count();
    }
    attributes_.emplace_back("/", cursor.attributes());
    const std::size_t variables = cursor.list(kVariableTag, 24);
    std::uint64_t record_variables = 0, only = 0, first_record = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t v = 0; v < variables; ++v) {
      ArrayInfo array;
      array.path = '/' + cursor.name();
      const std::size_t rank = cursor.items(4);
      if (rank > kMostClassicAxes) throw BadHeader{"a variable has too many axes"};
      ClassicPlace place;
      std::uint64_t bytes = 1;
      for (std::size_t i = 0; i < rank; ++i) {
        const std::uint64_t number = cursor.count();
        if (number >= axes.size()) throw BadHeader{"a variable has an axis that is not defined"};
        const Axis& axis = axes[static_cast<std::size_t>(number)];
        if (axis.length == 0 && i == 0) place.records = true;
        array.shape.push_back(axis.length);
        array.dimensions.push_back('/' + axis.name);
        if (i == 0 && place.records) continue;
        constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 60;
        if (axis.length > 0 && bytes > kMostBytes / axis.length) throw BadHeader{"a variable is too large"};
        bytes *= axis.length;
      }
      auto attributes = cursor.attributes();
      const std::uint32_t kind = cursor.type();
      (void)cursor.count();  // its size follows from its axes; that in the header may be wrong
      place.begin = cursor.offset();
      array.type = kClassicTypes[kind].type;
      array.type_name = kClassicTypes[kind].name;
      bytes *= bytes_of(kind);
      if (place.records) {
        ++record_variables;
        only = bytes;
        record_bytes_ += (bytes + 3) / 4 * 4;
        first_record = std::min(first_record, place.begin);
      }
      attributes_.emplace_back(array.path, std::move(attributes));
      arrays_.push_back(std::move(array));
      places_.push_back(place);
    }
    if (record_variables == 1) record_bytes_ = only;  // without padding
    const std::uint64_t size = bytes_.bytes.size();
    const std::uint64_t fit = record_bytes_ > 0 && first_record < size ? (size - first_record) / record_bytes_ : 0;
    if (streaming) records = fit;
    for (std::size_t v = 0; v < arrays_.size(); ++v) {
      if (places_[v].records) arrays_[v].shape[0] = records;
      if (arrays_[v].type == NumberType::none) continue;
      const std::uint64_t end = end_of(v);
      if (end > size)
        arrays_[v].problem =
            "the file is truncated: its values end at byte " + std::to_string(end) + " of " + std::to_string(size);
    }
  }

  const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  const std::vector<std::string>& groups() const override { return groups_; }

  std::vector<ArrayAttribute> attributes(const std::string& path) override {
    for (const auto& [name, found] : attributes_)
      if (name == path) return found;
    return {};
  }

  std::string read(std::size_t number, std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                   std::span<std::byte> to) override {
    if (number >= arrays_.size()) return "no such array";
    const ArrayInfo& array = arrays_[number];
    if (!array.problem.empty()) return array.problem;
    const std::size_t size = size_of(array.type), rank = array.shape.size();
    if (size == 0) return "it has no numbers";
    if (first.size() != rank || count.size() != rank) return "its axes differ";
    std::uint64_t values = 1;
    for (std::size_t i = 0; i < rank; ++i) {
      if (first[i] > array.shape[i] || count[i] > array.shape[i] - first[i]) return "the part lies outside";
      if (count[i] > 0 && values > to.size() / count[i]) return "the size differs";
      values *= count[i];
    }
    if (values * size != to.size()) return "the size differs";
    if (to.empty()) return {};
    const std::vector<std::uint64_t> steps = steps_of(number);
    // Trailing axes that are read as a whole form runs with the axis before them.
    std::size_t outer = rank;
    std::uint64_t run = 1;
    while (outer > 0) {
      const std::size_t axis = outer - 1;
      if (axis == 0 && places_[number].records && (rank > 1 || record_bytes_ != size)) break;
      run *= count[axis];
      --outer;
      if (count[axis] != array.shape[axis]) break;
    }
    std::uint64_t place = places_[number].begin;
    for (std::size_t i = 0; i < rank; ++i) place += first[i] * steps[i];
    NeededParts needed(bytes_.need);
    if (!needed.add_box(place, steps, count, size) || !needed.finish()) return "it cannot be received";
    std::vector<std::uint64_t> index(outer, 0);
    std::byte* next = to.data();
    for (;;) {
      if (place > bytes_.bytes.size() || run * size > bytes_.bytes.size() - place) return "the file is truncated";
      copy_native(bytes_.bytes.data() + place, size, static_cast<std::size_t>(run), next);
      next += run * size;
      std::size_t axis = outer;
      while (axis > 0) {
        --axis;
        place += steps[axis];
        if (++index[axis] < count[axis]) break;
        place -= steps[axis] * count[axis];
        index[axis] = 0;
        if (axis == 0) return {};
      }
      if (outer == 0) return {};
    }
  }

  void prepare(std::size_t number, std::span<const ArrayBox> boxes) override {
    if (!bytes_.need || number >= arrays_.size()) return;
    const std::size_t rank = arrays_[number].shape.size();
    const std::vector<std::uint64_t> steps = steps_of(number);
    NeededParts needed(bytes_.need);
    for (const ArrayBox& box : boxes) {
      if (box.first.size() != rank || box.count.size() != rank) return;
      std::uint64_t place = places_[number].begin;
      for (std::size_t i = 0; i < rank; ++i) place += box.first[i] * steps[i];
      if (!needed.add_box(place, steps, box.count, size_of(arrays_[number].type))) return;
    }
    (void)needed.finish();
  }

  std::vector<std::string> texts(std::size_t number) override {
    constexpr std::uint64_t kMostBytes = 1 << 20;
    if (number >= arrays_.size() || arrays_[number].type_name != "text" || arrays_[number].shape.size() != 2) return {};
    const std::uint64_t rows = arrays_[number].shape[0], length = arrays_[number].shape[1];
    const ClassicPlace& place = places_[number];
    const std::uint64_t step = place.records ? record_bytes_ : length;
    std::vector<std::string> all;
    if (length == 0 || rows > kMostBytes / length) return {};
    for (std::uint64_t row = 0; row < rows; ++row) {
      const std::uint64_t at = place.begin + row * step;
      if (at > bytes_.bytes.size() || length > bytes_.bytes.size() - at) return {};
      if (!have_bytes(bytes_.need, at, length)) return {};
      const std::string_view text(reinterpret_cast<const char*>(bytes_.bytes.data() + at),
                                  static_cast<std::size_t>(length));
      const std::size_t end = text.substr(0, text.find('\0')).find_last_not_of(' ');
      all.emplace_back(text.substr(0, end == std::string_view::npos ? 0 : end + 1));
    }
    return all;
  }

 private:
  /// Returns the distance in bytes between neighbouring elements along an axis.
  [[nodiscard]] std::vector<std::uint64_t> steps_of(std::size_t number) const {
    const ArrayInfo& array = arrays_[number];
    std::vector<std::uint64_t> steps(array.shape.size(), size_of(array.type));
    for (std::size_t i = steps.size(); i-- > 1;) steps[i - 1] = steps[i] * array.shape[i];
    if (places_[number].records) steps[0] = record_bytes_;
    return steps;
  }

  /// Returns the end of the values of a variable in the file.
  [[nodiscard]] std::uint64_t end_of(std::size_t number) const {
    const ArrayInfo& array = arrays_[number];
    constexpr auto kNever = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t bytes = size_of(array.type), records = 1;
    for (std::size_t i = 0; i < array.shape.size(); ++i) {
      if (array.shape[i] == 0) return places_[number].begin;
      if (i == 0 && places_[number].records)
        records = array.shape[0];
      else
        bytes *= array.shape[i];  // checked by read_header()
    }
    if (record_bytes_ > 0 && records - 1 > (kNever - bytes) / record_bytes_) return kNever;
    const std::uint64_t length = (records - 1) * record_bytes_ + bytes;
    return length > kNever - places_[number].begin ? kNever : places_[number].begin + length;
  }

  ArrayBytes bytes_;
  std::vector<ArrayInfo> arrays_;
  std::vector<ClassicPlace> places_;
  std::vector<std::string> groups_;
  std::vector<std::pair<std::string, std::vector<ArrayAttribute>>> attributes_;
  std::uint64_t record_bytes_ = 0;
};

}  // namespace

bool is_classic_netcdf(std::span<const std::byte> bytes) {
  if (bytes.size() < 8 || std::memcmp(bytes.data(), "CDF", 3) != 0) return false;
  const int version = std::to_integer<int>(bytes[3]);
  return version == 1 || version == 2 || version == 5;
}

ArrayFileResult open_classic_netcdf(ArrayBytes bytes) {
  if (!is_classic_netcdf(bytes.bytes)) return std::string("it does not begin with CDF and the version 1, 2 or 5");
  auto file = std::make_shared<ClassicFile>(std::move(bytes));
  try {
    file->read_header();
  } catch (const BadHeader& bad) {
    return std::string(bad.message);
  }
  return std::shared_ptr<ArrayFile>(std::move(file));
}

}  // namespace gs::app
