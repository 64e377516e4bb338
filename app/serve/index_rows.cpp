#include "app/serve/index_rows.h"

#include "base/text.h"

#include <string>
#include <string_view>
#include <unordered_map>

namespace gs::app {
namespace {

/// Extension of a header, and the extensions of its data, each followed by a blank.
struct HeaderRow {
  std::string_view header, data;
  bool numbered = false;  // a number may follow the name: Box0.bin
};
constexpr HeaderRow kHeaders[] = {
    {".nhdr", ".raw .raw.gz .raw.bz2 .img "},
    {".mhd", ".raw .raw.gz .zraw "},
    {".hdr", ".img .img.gz "},
    {".gltf", ".bin ", true},
    {".obj", ".mtl "},
};

/// Returns the extension, with the one before a compression: ".raw.gz".
std::string_view data_extension_of(std::string_view name) {
  std::size_t point = name.rfind('.');
  if (point != std::string_view::npos && point > 0 && (name.ends_with(".gz") || name.ends_with(".bz2")))
    if (const std::size_t before = name.rfind('.', point - 1); before != std::string_view::npos) point = before;
  return point == std::string_view::npos ? std::string_view() : name.substr(point);
}

/// Returns the header row of a name in lower case, or null.
const HeaderRow* header_row(std::string_view name) {
  for (const HeaderRow& row : kHeaders)
    if (name.size() > row.header.size() && name.ends_with(row.header)) return &row;
  return nullptr;
}

/// Returns the names that a header of this data file may have without extension: "a.be" and "a" for "a.be.raw".
std::vector<std::string> stems_of(std::string_view name, bool numbered) {
  std::vector<std::string> stems;
  for (std::size_t point = name.rfind('.'); point != std::string_view::npos && point > 0; point = name.rfind('.')) {
    name = name.substr(0, point);
    stems.emplace_back(name);
    const std::size_t last = name.find_last_not_of("0123456789");
    if (numbered && last != std::string_view::npos && last + 1 < name.size())
      stems.emplace_back(name.substr(0, last + 1));
  }
  return stems;
}

}  // namespace

std::vector<IndexRow> index_rows(std::span<const net::FolderEntry> entries) {
  std::unordered_map<std::string, std::size_t> headers;  // by name in lower case: index in `entries`
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (const std::string name = lower_case(entries[i].name); !entries[i].folder && header_row(name))
      headers.emplace(name, i);
  std::vector<std::vector<std::size_t>> data(entries.size());
  std::vector<bool> joined(entries.size());
  for (std::size_t i = 0; i < entries.size() && !headers.empty(); ++i) {
    const std::string name = lower_case(entries[i].name);
    const std::string extension = std::string(data_extension_of(name)) + ' ';
    if (entries[i].folder || header_row(name) || extension.size() < 2) continue;
    for (const HeaderRow& row : kHeaders) {
      if (row.data.find(extension) == std::string_view::npos) continue;
      for (const std::string& stem : stems_of(name, row.numbered))
        if (const auto header = headers.find(stem + std::string(row.header)); header != headers.end()) {
          data[header->second].push_back(i);
          joined[i] = true;
          break;
        }
    }
  }
  std::vector<IndexRow> rows;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (joined[i]) continue;
    IndexRow row{entries[i], {}};
    for (const std::size_t part : data[i]) {
      row.entry.size += entries[part].size;
      row.data.push_back(entries[part]);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace gs::app
