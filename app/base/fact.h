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

/// What a command tells, a value of JSON (RFC 8259): nothing, a truth, a number, a text, a list, or values by their
/// names in the order in which they were put. Its library stays behind it: that takes the compiler longer than most
/// files that tell something. One thread at a time.
class Fact {
 public:
  using Named = std::pair<std::string_view, Fact>;

  Fact();  // nothing
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

  /// Puts a value under a name, behind those that are there, or in the place of the one that has it. Nothing becomes
  /// values by names.
  void put(std::string_view name, Fact value);
  /// Puts a value behind those of a list. Nothing becomes a list.
  void add(Fact value);
  /// Neither a list's values nor named ones.
  [[nodiscard]] bool empty() const;

  /// JSON, indented, ASCII; what is no UTF-8 is replaced (U+FFFD). Ends with a line end.
  [[nodiscard]] std::string json() const;
  /// For people: a line for each value that has a name; lists of values that are no numbers, and what is named
  /// "metadata", have one for each of theirs.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  struct Value;
  std::unique_ptr<Value> value_;
};

/// Whether a text is JSON, of values by names, one of which is `name`. Safe for untrusted texts.
[[nodiscard]] bool is_json_with(std::string_view text, std::string_view name);

}  // namespace gs::app
