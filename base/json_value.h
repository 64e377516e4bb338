#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gs {

/// JSON value (RFC 8259) that a command reports: null, boolean, number, string, list or object in insertion order.
/// Hides its JSON library, which is slow to compile. One thread at a time.
class JsonValue {
 public:
  using Named = std::pair<std::string_view, JsonValue>;

  JsonValue();  // null
  JsonValue(bool truth);
  JsonValue(double number);
  JsonValue(std::int64_t number);
  JsonValue(std::uint64_t number);
  template <std::integral T>
  requires(!std::same_as<T, bool>) JsonValue(T number)
      : JsonValue(static_cast<std::conditional_t<std::signed_integral<T>, std::int64_t, std::uint64_t>>(number)) {}
  JsonValue(float number) : JsonValue(static_cast<double>(number)) {}
  JsonValue(std::string_view text);
  JsonValue(const char* text) : JsonValue(std::string_view(text)) {}
  JsonValue(const std::string& text) : JsonValue(std::string_view(text)) {}
  JsonValue(const JsonValue& other);
  JsonValue(JsonValue&& other) noexcept;
  JsonValue& operator=(JsonValue other) noexcept;
  ~JsonValue();

  [[nodiscard]] static JsonValue list(std::initializer_list<JsonValue> values = {});
  [[nodiscard]] static JsonValue named(std::initializer_list<Named> values = {});

  /// Sets the member `name`: appends it, or replaces the existing one. A null value becomes an object first.
  void put(std::string_view name, JsonValue value);
  /// Appends a value to a list. A null value becomes a list first.
  void add(JsonValue value);
  /// Returns true for a value without list elements and without members.
  [[nodiscard]] bool empty() const;

  /// Returns indented ASCII JSON with a trailing line end. Invalid UTF-8 becomes U+FFFD.
  [[nodiscard]] std::string json() const;
  /// Returns lines for users, one per member. The member "metadata", and lists of values other than numbers, have one
  /// line per element.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  struct Value;
  std::unique_ptr<Value> value_;
};

/// Returns true if a text is a JSON object with a member `name`. Safe for untrusted texts.
[[nodiscard]] bool is_json_with(std::string_view text, std::string_view name);

}  // namespace gs
