#include "base/diagnostic.h"

#include <map>
#include <string_view>
#include <tuple>
#include <utility>

namespace gs {

std::string Diagnostic::text() const {
  std::string out = file;
  if (location.line) out += ':' + std::to_string(location.line) + ':' + std::to_string(location.column);
  out += severity == Severity::error ? ": error: " : severity == Severity::warning ? ": warning: " : ": note: ";
  return out + message;
}

void Diagnostics::add(Diagnostic diagnostic) {
  if (diagnostic.severity == Severity::error) ++errors_;
  if (diagnostic.severity == Severity::warning) ++warnings_;
  if (entries_.size() < capacity_) {
    entries_.push_back(std::move(diagnostic));
  } else {
    ++dropped_;
  }
}

void Diagnostics::append(const Diagnostics& other) {
  for (const Diagnostic& diagnostic : other.entries_) {
    if (entries_.size() < capacity_) {
      entries_.push_back(diagnostic);
    } else {
      ++dropped_;
    }
  }
  errors_ += other.errors_;
  warnings_ += other.warnings_;
  dropped_ += other.dropped_;
}

std::vector<CountedDiagnostic> joined(const std::vector<Diagnostic>& diagnostics) {
  std::vector<CountedDiagnostic> result;
  std::map<std::tuple<Severity, std::string_view, std::string_view>, std::size_t> known;
  for (const Diagnostic& one : diagnostics) {
    if (one.severity != Severity::error) {
      const auto [at, fresh] = known.try_emplace({one.severity, one.file, one.message}, result.size());
      if (!fresh) {
        ++result[at->second].count;
        continue;
      }
    }
    result.push_back({&one, 1});
  }
  return result;
}

std::string text_of(const CountedDiagnostic& diagnostic) {
  std::string text = diagnostic.first->text();
  if (diagnostic.count > 1) text += " (" + std::to_string(diagnostic.count) + " times)";
  return text;
}

}  // namespace gs
