#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

// Habits of programs for Contact that ECMAScript refuses.
namespace gs::app::script {

/// Prefix of the name of the function that handles the events of an exposedField.
inline constexpr std::string_view kHandlerPrefix = "$on_";

/// Rewrites two habits, and keeps line numbers:
///   `function x` beside an exposedField x becomes `function $on_x`, and calls of it too. `exposed` holds the names of
///   the exposedFields.
///   `Browser.f(...)` becomes `$browser("f").f(...)` if `is_method` is false for f.
[[nodiscard]] std::string contact_text(std::string text, const std::vector<std::string>& exposed,
                                       const std::function<bool(std::string_view)>& is_method);

/// Names that a program reads, assigns or tests without declaring them in its outermost scope. Contact lets programs
/// read them. Holds hashes of at most kMaxNames names.
class UndeclaredNames {
 public:
  static constexpr std::size_t kMaxNames = 4096;

  UndeclaredNames() = default;
  explicit UndeclaredNames(std::string_view program);
  [[nodiscard]] bool contains(std::string_view name) const;
  /// Reports whether the program tests the name by `typeof`, so that the author knows that it may be undeclared.
  [[nodiscard]] bool is_tested(std::string_view name) const;

 private:
  std::vector<std::uint64_t> names_, tested_;  // sorted
};

}  // namespace gs::app::script
