#include "app/control/json_values.h"

#include "vrml/scene/values/field_numbers.h"

#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

/// Element that consists of several numbers.
template <class T>
concept Tuple = vrml::ElementNumbers<T>::kCount >
1;

template <Tuple T>
std::string expected_numbers() {
  return "a list of " + std::to_string(vrml::ElementNumbers<T>::kCount) + " numbers";
}

class ValueReader {
 public:
  ValueReader(JsonCursor& json, const ReadNode& node, std::string& problem)
      : json_(json), node_(node), problem_(problem) {}

  template <class T>
  bool read(T& value) {
    if constexpr (Tuple<T>) {
      if (json_.kind() != JsonKind::list) return expected(expected_numbers<T>());
      json_.open();
      T read_value{};
      for (int i = 0; i < vrml::ElementNumbers<T>::kCount; ++i)
        if (!json_.more() || !read(vrml::numbers_of(read_value)[i])) return expected(expected_numbers<T>());
      if (json_.more()) return expected(expected_numbers<T>());
      value = read_value;
      return true;
    } else if constexpr (std::is_same_v<T, vrml::Double>) {
      return read(value.value);
    } else if constexpr (std::is_same_v<T, bool>) {
      if (json_.kind() != JsonKind::boolean) return expected("true or false");
      value = json_.boolean();
      return true;
    } else if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double>) {
      if (json_.kind() != JsonKind::number) return expected("a number");
      const double number = json_.number();
      value = static_cast<T>(number);
      return std::isfinite(value) || expected("a smaller number");
    } else if constexpr (std::is_same_v<T, std::int32_t>) {
      return read_whole(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(), value);
    } else if constexpr (std::is_same_v<T, vrml::String>) {
      if (json_.kind() != JsonKind::string) return expected("a string");
      value = vrml::String(json_.string(scratch_));
      return true;
    } else if constexpr (std::is_same_v<T, vrml::NodeId>) {
      if (json_.kind() == JsonKind::null) {
        (void)json_.skip();
        value = {};
        return true;
      }
      const auto found = node_(json_, problem_);
      if (found) value = *found;
      return found.has_value();
    } else if constexpr (std::is_same_v<T, vrml::PixelImage>) {
      return read_image(value);
    } else {
      return read_list(value);
    }
  }

  template <class T, int kInitial>
  bool read(Boxed<T, kInitial>& value) {
    return read(value.edit());
  }

 private:
  bool expected(const std::string& what) {
    if (problem_.empty()) problem_ = "expected " + what;
    return false;
  }
  template <class Whole>
  bool read_whole(double least, double most, Whole& value) {
    if (json_.kind() != JsonKind::number) return expected("a whole number");
    const double number = json_.number();
    if (!(number >= least && number <= most) || number != std::trunc(number))
      return expected("a whole number from " + std::to_string(static_cast<std::int64_t>(least)) + " to " +
                      std::to_string(static_cast<std::int64_t>(most)));
    value = static_cast<Whole>(number);
    return true;
  }
  // Reads an image (VRML97 5.5): width, height, components, then one number per pixel with one byte per component.
  bool read_image(vrml::PixelImage& value) {
    if (json_.kind() != JsonKind::list) return expected("a list of width, height, components and pixels");
    json_.open();
    Array<std::uint32_t> words;
    double most = 4294967295.0;
    std::uint64_t pixels = 0;
    for (std::size_t i = 0; json_.more(); ++i) {
      std::uint32_t word = 0;
      if (!read_whole(0, most, word)) return false;
      words.push_back(word);
      if (i < 2) continue;
      if (i == 2) {
        if (word > 4) return expected("0 to 4 components");
        pixels = std::uint64_t{words[0]} * words[1];
        most = std::pow(256.0, word) - 1;
      } else if (i - 2 > pixels) {
        return expected("one number per pixel");
      }
    }
    if (words.size() < 3 || words.size() - 3 != pixels)
      return expected("width, height, components and one number per pixel");
    if (pixels == 0) words.clear();
    value.words = std::move(words);
    return true;
  }
  template <class T>
  bool read_list(Array<T>& value) {
    if (json_.kind() != JsonKind::list) return expected("a list");
    json_.open();
    Array<T> list;
    bool flat = false;
    while (json_.more()) {
      T one{};
      if constexpr (Tuple<T>) {
        if (list.empty()) flat = json_.kind() == JsonKind::number;
        if (flat) {
          constexpr int kCount = vrml::ElementNumbers<T>::kCount;
          for (int i = 0; i < kCount; ++i)
            if ((i > 0 && !json_.more()) || !read(vrml::numbers_of(one)[i]))
              return expected("a multiple of " + std::to_string(kCount) + " numbers");
          list.push_back(one);
          continue;
        }
      }
      if (!read(one)) return false;
      list.push_back(std::move(one));
    }
    value = std::move(list);
    return true;
  }

  JsonCursor& json_;
  const ReadNode& node_;
  std::string& problem_;
  std::string scratch_;
};

struct ValueWriter {
  std::string& out;
  const WriteNode& node;

  void operator()(bool value) const { out += value ? "true" : "false"; }
  void operator()(float value) const { append_json_number(out, value); }
  void operator()(double value) const { append_json_number(out, value); }
  void operator()(std::int32_t value) const { out += std::to_string(value); }
  void operator()(const vrml::String& value) const { append_json_string(out, value.view()); }
  void operator()(vrml::NodeId value) const {
    if (value) {
      node(out, value);
    } else {
      out += "null";
    }
  }
  void operator()(const vrml::PixelImage& value) const {
    out += '[' + std::to_string(value.width()) + ',' + std::to_string(value.height()) + ',' +
           std::to_string(value.components());
    for (const std::uint32_t pixel : value.pixels()) out += ',' + std::to_string(pixel);
    out += ']';
  }
  template <class T>
  void operator()(const Array<T>& value) const {
    list(value);
  }
  template <class T, int kInitial>
  void operator()(const Boxed<T, kInitial>& value) const {
    (*this)(*value);
  }
  template <Tuple T>
  void operator()(const T& value) const {
    list(std::span(vrml::numbers_of(value), vrml::ElementNumbers<T>::kCount));
  }

 private:
  template <class List>
  void list(const List& values) const {
    out += '[';
    bool first = true;
    for (const auto& one : values) {
      if (!std::exchange(first, false)) out += ',';
      (*this)(one);
    }
    out += ']';
  }
};

template <std::size_t... kIndex>
bool read_typed(ValueReader& reader, vrml::FieldType type, vrml::FieldValue& value, std::index_sequence<kIndex...>) {
  bool good = false;
  (void)((static_cast<std::size_t>(type) == kIndex && (good = reader.read(value.emplace<kIndex>()), true)) || ...);
  return good;
}

}  // namespace

std::optional<vrml::FieldValue> read_json_value(JsonCursor& json, vrml::FieldType type, const ReadNode& node,
                                                std::string& problem) {
  std::optional<vrml::FieldValue> value(std::in_place);
  problem.clear();
  ValueReader reader(json, node, problem);
  if (!read_typed(reader, type, *value, std::make_index_sequence<vrml::kFieldTypeCount>())) return std::nullopt;
  return value;
}

void append_json_value(std::string& out, const vrml::FieldValue& value, const WriteNode& node) {
  std::visit([writer = ValueWriter{out, node}](const auto& one) { writer(one); }, value);
}

}  // namespace gs::app
