#pragma once

#include "app/formats/common/voxel_component.h"
#include "base/array.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// Values that this process and its children send to each other. Both are the same program, so the bytes have no
// versions. Readers trust nothing.
namespace gs::app {

/// Writer of values in the layout of this program, for another process of it.
class TransferWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void value(const T& value) { raw(std::as_bytes(std::span(&value, 1))); }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void list(std::span<const T> values) {
    value<std::uint64_t>(values.size());
    raw(std::as_bytes(values));
  }
  template <class T>
  void list(const std::vector<T>& values) {
    list(std::span<const T>(values));
  }
  template <class T>
  void list(const Array<T>& values) {
    list(values.span());
  }
  void text(std::string_view text) { list(std::span(text.data(), text.size())); }
  /// Appends what another writer has written.
  void append(const TransferWriter& other) { raw(other.bytes_); }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void raw(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  std::vector<std::byte> bytes_;
};

/// Exception for bytes that no honest child sends.
struct Impossible {};

/// Reader of what TransferWriter writes. Throws Impossible at the end of the bytes.
class TransferReader {
 public:
  explicit TransferReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  requires std::is_trivially_copyable_v<T> T value() {
    T value;
    const auto from = take(sizeof(T));
    std::memcpy(&value, from.data(), sizeof(T));
    return value;
  }
  /// Reads a truth value. A bool with other bits would be undefined behaviour.
  bool truth() { return value<std::uint8_t>() != 0; }
  template <class T>
  std::vector<T> list() {
    const auto from = take_list(sizeof(T));
    std::vector<T> values(from.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), from.data(), from.size());
    return values;
  }
  template <class T>
  Array<T> array() {
    const auto from = take_list(sizeof(T));
    Array<T> values;
    if (from.empty()) return values;
    std::memcpy(static_cast<void*>(values.prepare(from.size() / sizeof(T))), from.data(), from.size());
    values.commit(from.size() / sizeof(T));
    return values;
  }
  /// Reads a text and replaces its control characters.
  std::string text() {
    const auto from = take_list(1);
    std::string text(reinterpret_cast<const char*>(from.data()), from.size());
    for (char& c : text)
      if ((static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t') || c == 127) c = '?';
    return text;
  }
  /// Reads a list of bytes, which belong to the source of this reader.
  std::span<const std::byte> bytes() { return take_list(1); }
  /// Reads a number of things of at least `bytes` bytes each.
  std::size_t count(std::size_t bytes) {
    const auto count = value<std::uint64_t>();
    if (count > rest_.size() / bytes) throw Impossible();
    return static_cast<std::size_t>(count);
  }
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> take(std::size_t count) {
    if (count > rest_.size()) throw Impossible();
    const auto front = rest_.first(count);
    rest_ = rest_.subspan(count);
    return front;
  }
  std::span<const std::byte> take_list(std::size_t bytes) { return take(count(bytes) * bytes); }

  std::span<const std::byte> rest_;
};

/// Throws Impossible if a condition does not hold.
inline void require_possible(bool holds) {
  if (!holds) throw Impossible();
}

/// Returns the code of a choice that may be left open: 0, or 1 for no and 2 for yes.
inline std::uint8_t choice_code(std::optional<bool> choice) { return !choice ? 0 : *choice ? 2 : 1; }
inline std::optional<bool> read_choice(TransferReader& from) {
  const auto code = from.value<std::uint8_t>();
  return code == 0 ? std::nullopt : std::optional(code == 2);
}

inline void write_component(TransferWriter& to, const VoxelComponent& component) {
  to.value(component.index);
  to.value<std::uint8_t>(component.chosen);
  to.value<std::uint8_t>(component.magnitude);
  to.value(choice_code(component.labels));
  to.text(component.folder);
  to.text(component.dataset);
  to.value<std::uint8_t>(component.channel.has_value());
  to.value<std::uint64_t>(component.channel.value_or(0));
  to.value(choice_code(component.globe));
  to.value<std::uint8_t>(component.served);
  to.value<std::uint8_t>(component.by_view);
  to.value<std::uint8_t>(component.step ? (component.step->time ? 2 : 1) : 0);
  to.value<std::uint32_t>(component.step ? component.step->number : 0);
  to.value<double>(component.step ? component.step->time.value_or(0) : 0);
  to.value<std::uint8_t>(component.growing);
  to.value(component.flow);
  to.value(component.colors.range);
  to.value(component.colors.low);
  to.value(component.colors.high);
  to.list(component.colors.map);
}

inline VoxelComponent read_component(TransferReader& from) {
  VoxelComponent component;
  component.index = from.value<std::uint32_t>();
  component.chosen = from.truth();
  component.magnitude = from.truth();
  component.labels = read_choice(from);
  component.folder = from.text();
  component.dataset = from.text();
  const bool has_channel = from.truth();
  const auto channel = from.value<std::uint64_t>();
  if (has_channel) component.channel = channel;
  component.globe = read_choice(from);
  component.served = from.truth();
  component.by_view = from.truth();
  const auto step = from.value<std::uint8_t>();
  const auto number = from.value<std::uint32_t>();
  const auto time = from.value<double>();
  if (step != 0) component.step = qnv::ShownStep{number, {}};
  if (step == 2) component.step->time = time;
  component.growing = from.truth();
  const auto flow = from.value<std::uint8_t>(), range = from.value<std::uint8_t>();
  require_possible(flow <= static_cast<std::uint8_t>(FlowForm::streamlines) &&
                   range <= static_cast<std::uint8_t>(SurfaceColors::Range::typed));
  component.flow = static_cast<FlowForm>(flow);
  component.colors.range = static_cast<SurfaceColors::Range>(range);
  component.colors.low = from.value<double>();
  component.colors.high = from.value<double>();
  component.colors.map = from.list<glm::vec3>();
  return component;
}

}  // namespace gs::app
