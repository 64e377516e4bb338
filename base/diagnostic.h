#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs {

/// Position in a text. Line and column count from 1; the column counts bytes. {0, 0} means the whole file.
struct SourceLocation {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  friend bool operator==(const SourceLocation&, const SourceLocation&) = default;
};

enum class Severity : std::uint8_t { note, warning, error };

/// Message about a problem, its position, and the expected input.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string file;
  SourceLocation location;
  std::string message;

  /// Returns `file:line:col: error: message`, or `file: error: message` if the line is unknown.
  [[nodiscard]] std::string text() const;
};

/// Diagnostics of one load. Counts all of them but stores only the first `capacity`, so that a hostile file cannot
/// exhaust memory.
class Diagnostics {
 public:
  static constexpr std::size_t kCapacity = 1000;
  Diagnostics() : Diagnostics(kCapacity) {}
  explicit Diagnostics(std::size_t capacity) : capacity_(capacity) {}

  void add(Diagnostic diagnostic);
  void append(const Diagnostics& other);

  [[nodiscard]] const std::vector<Diagnostic>& entries() const { return entries_; }
  [[nodiscard]] std::size_t errors() const { return errors_; }
  [[nodiscard]] std::size_t warnings() const { return warnings_; }
  /// Returns the number of diagnostics that were counted but not stored.
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

 private:
  std::size_t capacity_;
  std::vector<Diagnostic> entries_;
  std::size_t errors_ = 0, warnings_ = 0, dropped_ = 0;
};

/// Diagnostic with the number of equal ones: those with its severity, file and message at any position.
struct CountedDiagnostic {
  const Diagnostic* first;
  std::size_t count;
};
/// Joins equal warnings and notes, in the order of the first of each. Errors stay separate, because each position needs
/// a correction. The result refers to `diagnostics`.
[[nodiscard]] std::vector<CountedDiagnostic> joined(const std::vector<Diagnostic>& diagnostics);
/// Returns the text of the first diagnostic, with the count if there are several.
[[nodiscard]] std::string text_of(const CountedDiagnostic& diagnostic);

}  // namespace gs
