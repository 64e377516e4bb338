#include "app/session/documents/session_log.h"

#include <algorithm>

namespace gs::app {
namespace {

bool same_entry(const Diagnostic& a, const Diagnostic& b) {
  return a.severity == b.severity && a.location == b.location && a.message == b.message && a.file == b.file;
}

}  // namespace

void SessionLog::note(std::string_view path, const Diagnostics& diagnostics) {
  auto file = std::find_if(files_.begin(), files_.end(), [&](const File& one) { return one.path == path; });
  if (file == files_.end()) {
    if (files_.size() >= kMaxFiles) files_.erase(files_.begin());
    file = files_.insert(files_.end(), File{std::string(path), {}, 0});
  }
  // During one reading, the list of diagnostics only grows. If old entries have changed, this is another reading, and
  // all its diagnostics count as new.
  const auto& now = diagnostics.entries();
  const auto& before = file->diagnostics.entries();
  const std::size_t told = std::min(file->told, now.size());
  file->told = std::equal(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(told), before.begin(), same_entry)
                   ? told
                   : std::size_t{0};
  file->diagnostics = diagnostics;
}

std::size_t SessionLog::errors() const {
  std::size_t sum = 0;
  for (const File& file : files_) sum += file.diagnostics.errors();
  return sum;
}

std::size_t SessionLog::warnings() const {
  std::size_t sum = 0;
  for (const File& file : files_) sum += file.diagnostics.warnings();
  return sum;
}

std::size_t SessionLog::entries() const {
  std::size_t sum = 0;
  for (const File& file : files_) sum += file.diagnostics.entries().size();
  return sum;
}

std::size_t SessionLog::dropped() const {
  std::size_t sum = 0;
  for (const File& file : files_) sum += file.diagnostics.dropped();
  return sum;
}

std::vector<std::string> SessionLog::take_untold() {
  std::vector<std::string> lines;
  for (File& file : files_)
    for (const auto& entries = file.diagnostics.entries(); file.told < entries.size(); ++file.told)
      lines.push_back(entries[file.told].text());
  return lines;
}

}  // namespace gs::app
