#include "bench/shared/sog_peer.h"

#include "app/formats/export/export.h"
#include "app/formats/splats/sog_levels.h"
#include "app/formats/splats/splat_join.h"
#include "app/formats/splats/splats_sog.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::bench {
namespace {

std::vector<std::byte> contents_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::size_t bytes_in(const std::filesystem::path& folder) {
  std::size_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) bytes += entry.file_size();
  return bytes;
}

}  // namespace

SogPeer sog_of(const qnv::Gaussians& source) {
  SogPeer peer;
  const auto made = app::export_sog(qnv::Geometry(source));
  const auto* const bytes = std::get_if<std::vector<std::byte>>(&made);
  if (!bytes) return peer;
  Diagnostics diagnostics;
  const std::string name = "peer.sog";
  app::Asset read = app::read_splats_sog({*bytes, name, {}, own_budget(), diagnostics});
  auto* const gaussians = std::get_if<qnv::Gaussians>(&read);
  if (!gaussians) return peer;
  peer.bytes = bytes->size();
  peer.gaussians = std::move(*gaussians);
  return peer;
}

std::vector<SogPeer> sog_levels_of(const std::string& folder) {
  const std::filesystem::path place(folder);
  const std::vector<std::byte> list = contents_of(place / app::kSogLevelsName);
  const auto parsed = app::parse_sog_levels(list, own_budget());
  const auto* const levels = std::get_if<app::SogLevels>(&parsed);
  if (!levels) return {};
  const app::ReadFile read = [&](const std::string& path) -> app::BytesResult {
    return app::shared_bytes(contents_of(place / path));
  };
  std::vector<SogPeer> peers;
  for (std::size_t level = levels->levels; level-- > 0;) {
    std::map<std::size_t, std::vector<app::SogRun>> by_file;
    for (const app::SogLeaf& leaf : levels->leaves)
      for (const app::SogRun& run : leaf.runs)
        if (run.level == level) by_file[run.file].push_back(run);
    SogPeer peer;
    peer.bytes = peers.empty() ? list.size() : peers.front().bytes;
    for (const auto& [file, runs] : by_file) {
      const std::string text = app::text_of_sog_parts({levels->files[file], runs});
      Diagnostics diagnostics;
      app::Asset part =
          app::read_splats_sog_levels({std::as_bytes(std::span(text)), folder, read, own_budget(), diagnostics});
      if (const auto* const splats = std::get_if<qnv::Gaussians>(&part)) app::append_splats(peer.gaussians, *splats);
      peer.bytes += bytes_in((place / levels->files[file]).parent_path());
    }
    if (!peer.gaussians.empty()) peers.push_back(std::move(peer));
  }
  return peers;
}

}  // namespace gs::bench
