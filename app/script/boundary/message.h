#pragma once

#include "app/script/boundary/program_host.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

// Messages between a world and the process that runs its programs. A message is a sequence of items. Neither side
// trusts the other: readers check every length and number, and stop at the first wrong one.
namespace gs::app::script {

/// Kind of an item. A message of the world is orders or one answer. A message of the programs is notices and reports,
/// and then at most one question. Each order has a report; the notices and questions before it belong to that order.
enum class ItemKind : std::uint8_t { order, answer, notice, question, report };

/// Writer of a message.
class MessageWriter {
 public:
  void begin(ItemKind kind) { number(static_cast<std::uint8_t>(kind)); }
  template <class T>
  void number(T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    raw(&value, sizeof value);
  }
  void text(std::string_view text);
  void raw(const void* data, std::size_t bytes) {
    const auto* const first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + bytes);
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reader of a message. After the first wrong or missing byte, good() returns false and all values are empty.
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  void fail() {
    good_ = false;
    rest_ = {};
  }
  template <class T>
  [[nodiscard]] T number() {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    T value{};
    raw(&value, sizeof value);
    return value;
  }
  [[nodiscard]] bool truth() { return number<std::uint8_t>() != 0; }
  /// Reads a number below `count`.
  [[nodiscard]] std::uint32_t below(std::uint32_t count);
  [[nodiscard]] std::string text();
  /// Reads the number of elements that take at least `bytes` bytes each.
  [[nodiscard]] std::size_t count(std::size_t bytes);
  void raw(void* to, std::size_t bytes) {
    if (bytes > rest_.size()) return fail();
    if (bytes == 0) return;
    std::memcpy(to, rest_.data(), bytes);
    rest_ = rest_.subspan(bytes);
  }

 private:
  std::span<const std::byte> rest_;
  bool good_ = true;
};

void write(MessageWriter& to, const vrml::FieldValue& value);
void write(MessageWriter& to, const Order& order);
void write(MessageWriter& to, const Answer& answer);
void write(MessageWriter& to, const Notice& notice);
void write(MessageWriter& to, const Question& question);
void write(MessageWriter& to, const Report& report);

// Readers of the items, after their kind. Check MessageReader::good() afterwards.
[[nodiscard]] vrml::FieldValue read_value(MessageReader& from);
[[nodiscard]] Order read_order(MessageReader& from);
[[nodiscard]] Answer read_answer(MessageReader& from);
[[nodiscard]] Notice read_notice(MessageReader& from);
[[nodiscard]] Question read_question(MessageReader& from);
[[nodiscard]] Report read_report(MessageReader& from);

}  // namespace gs::app::script
