#include "base/diagnostic.h"

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

}  // namespace gs
