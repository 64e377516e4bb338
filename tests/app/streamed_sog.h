#pragma once

#include "app/formats/archive/zip_archive.h"
#include "app/formats/export/export.h"
#include "base/box.h"
#include "qnv/base/geometry.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::test {

/// Files by their paths.
using SogFiles = std::map<std::string, std::vector<std::byte>>;

/// Part of a streamed SOG.
struct SogPart {
  Box box;                             // in the axes of VRML97
  std::vector<qnv::Gaussians> levels;  // the finest first
};

/// Returns a streamed SOG with one file for each level of each part: "LEVEL_PART/meta.json", and lod-meta.json.
inline SogFiles streamed_sog(std::span<const SogPart> parts) {
  SogFiles files;
  nlohmann::ordered_json list, children = nlohmann::ordered_json::array(), names = nlohmann::ordered_json::array();
  std::size_t levels = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Box& box = parts[p].box;
    nlohmann::ordered_json leaf;
    // The axes of the file are right, down, forward.
    leaf["bound"] = {{"min", {box.lower.x, -box.upper.y, -box.upper.z}},
                     {"max", {box.upper.x, -box.lower.y, -box.lower.z}}};
    for (std::size_t l = 0; l < parts[p].levels.size(); ++l) {
      const std::string folder = std::to_string(l) + "_" + std::to_string(p) + "/";
      const auto made = app::export_sog(parts[p].levels[l]);
      const auto* const bytes = std::get_if<std::vector<std::byte>>(&made);
      if (!bytes) return {};
      const auto opened = app::ZipArchive::open(*bytes);
      const auto& archive = std::get<app::ZipArchive>(opened);
      for (const std::string& path : archive.paths())
        files[folder + path] = std::get<std::vector<std::byte>>(*archive.read_path(path, own_budget()));
      const auto& meta = files[folder + "meta.json"];
      const auto* const text = reinterpret_cast<const char*>(meta.data());
      leaf["lods"][std::to_string(l)] = {
          {"file", names.size()}, {"offset", 0}, {"count", nlohmann::json::parse(text, text + meta.size())["count"]}};
      names.push_back(folder + "meta.json");
      levels = std::max(levels, l + 1);
    }
    children.push_back(std::move(leaf));
  }
  list["version"] = 1;
  list["lodLevels"] = levels;
  list["environment"] = nullptr;
  list["filenames"] = std::move(names);
  list["tree"]["children"] = std::move(children);
  const std::string text = list.dump();
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  files["lod-meta.json"] = {first, first + text.size()};
  return files;
}

}  // namespace gs::test
