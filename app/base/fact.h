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

namespace gs::app {

/// JSON value (RFC 8259) that a command reports: null, boolean, number, string, list or object in insertion order.
/// Hides its JSON library, which is slow to compile. One thread at a time.
class Fact {
 public:
  using Named = std::pair<std::string_view, Fact>;

  Fact();  // null
  Fact(bool truth);
  Fact(double number);
  Fact(std::int64_t number);
  Fact(std::uint64_t number);
  template <std::integral T>
  requires(!std::same_as<T, bool>) Fact(T number)
      : Fact(static_cast<std::conditional_t<std::signed_integral<T>, std::int64_t, std::uint64_t>>(number)) {}
  Fact(float number) : Fact(static_cast<double>(number)) {}
  Fact(std::string_view text);
  Fact(const char* text) : Fact(std::string_view(text)) {}
  Fact(const std::string& text) : Fact(std::string_view(text)) {}
  Fact(const Fact& other);
  Fact(Fact&& other) noexcept;
  Fact& operator=(Fact other) noexcept;
  ~Fact();

  [[nodiscard]] static Fact list(std::initializer_list<Fact> values = {});
  [[nodiscard]] static Fact named(std::initializer_list<Named> values = {});

  /// Sets the value of a name: appends it, or replaces the existing one. Null becomes an object.
  void put(std::string_view name, Fact value);
  /// Appends a value to a list. Null becomes a list.
  void add(Fact value);
  /// Returns true for a value without list elements and without members.
  [[nodiscard]] bool empty() const;

  /// Returns indented ASCII JSON with a trailing line end. Invalid UTF-8 becomes U+FFFD.
  [[nodiscard]] std::string json() const;
  /// Returns lines for users, one per named value. Lists of values other than numbers, and the member "metadata", have
  /// one line per element.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  struct Value;
  std::unique_ptr<Value> value_;
};

/// Returns true if a text is a JSON object with a member `name`. Safe for untrusted texts.
[[nodiscard]] bool is_json_with(std::string_view text, std::string_view name);

}  // namespace gs::app
