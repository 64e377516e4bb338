#include "app/scene_reader.h"

#include "app/cloud_reader.h"
#include "app/content_types.h"
#include "app/gunzip.h"
#include "app/references.h"
#include "net/file.h"
#include "net/url.h"
#include "vrml/parser.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using vrml::Severity;

// A hostile .wrz can promise a thousand times its size.
constexpr std::size_t kMaxUnpacked = std::size_t{4} << 30;
// How much is parsed between two looks at the clock.
constexpr std::size_t kPiece = std::size_t{8} << 20;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct ParseRun {
  vrml::Parser parser;
  vrml::SceneGraph& scene;
  vrml::Diagnostics& diagnostics;
  const LoadLimit& limit;
  bool late = false;

  bool push(std::string_view text) {
    while (!text.empty() && !late) {
      parser.push(text.substr(0, kPiece));
      text.remove_prefix(std::min(text.size(), kPiece));
      late = limit.over();
    }
    if (late && !text.empty())
      diagnostics.add(
          {Severity::error, scene.file_name(), {}, "the time for loading is over; the rest of the file is left out"});
    return !late;
  }
};

// VRML97, gzip'd or not. True when the whole text was there.
bool read_vrml(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics,
               const LoadLimit& limit, bool& refused) {
  ParseRun run{vrml::Parser(scene, diagnostics), scene, diagnostics, limit};
  bool whole = true;
  if (is_gzip(bytes)) {
    if (const auto problem = gunzip(bytes, kMaxUnpacked, [&](std::string_view piece) { return run.push(piece); })) {
      diagnostics.add({Severity::error, scene.file_name(), {}, *problem});
      whole = false;
    }
  } else {
    run.push(text_of(bytes));
  }
  const vrml::ParseOutcome outcome = run.parser.finish();
  refused = outcome == vrml::ParseOutcome::refused;
  return whole && !run.late && outcome == vrml::ParseOutcome::complete;
}

std::optional<std::vector<std::byte>> unpacked(std::span<const std::byte> bytes, vrml::Diagnostics& diagnostics,
                                               const std::string& file) {
  std::vector<std::byte> out;
  const auto problem = gunzip(bytes, kMaxUnpacked, [&](std::string_view piece) {
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    out.insert(out.end(), first, first + piece.size());
    return true;
  });
  if (problem) diagnostics.add({Severity::error, file, {}, *problem});
  if (out.empty()) return std::nullopt;
  return out;
}

ReadFile reader_beside(const std::string& path) {
  const net::Url base = net::url_of_path(path);
  return [base](const std::string& name) -> std::optional<std::vector<std::byte>> {
    const auto file = open_reference(base, name);
    if (!file) return std::nullopt;
    return std::vector<std::byte>(file->bytes().begin(), file->bytes().end());
  };
}

// The nodes of a mesh's file. True when there is nothing to show.
bool read_mesh(const ContentType& type, const std::string& path, std::span<const std::byte> bytes,
               vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics) {
  if (bytes.empty()) {
    diagnostics.add({Severity::error, path, {}, "the file is empty; expected " + std::string(type.name)});
    return true;
  }
  const std::size_t errors = diagnostics.errors();
  std::optional<std::vector<std::byte>> packed;
  if (is_gzip(bytes)) packed = unpacked(bytes, diagnostics, path);
  type.import(packed ? std::span<const std::byte>(*packed) : bytes, scene, diagnostics, reader_beside(path));
  const bool refused = scene.roots().empty();
  if (refused && diagnostics.errors() == errors)
    diagnostics.add({Severity::error, path, {}, "holds nothing to show; read as " + std::string(type.name)});
  return refused;
}

}  // namespace

SceneRead read_scene(const std::string& path, std::span<const std::byte> bytes, vrml::Diagnostics& diagnostics,
                     const LoadLimit& limit, const Arrival& arrival) {
  SceneRead read;
  auto scene = std::make_unique<vrml::SceneGraph>(path);
  const ContentType& type = content_type_of(path, first_bytes(bytes));
  bool refused = false;
  if (type.content == ContentClass::vrml) {
    read.whole = read_vrml(bytes, *scene, diagnostics, limit, refused);
  } else if (type.content == ContentClass::mesh) {
    refused = read_mesh(type, path, bytes, *scene, diagnostics);
  } else {
    auto cloud = read_cloud(type, {path, bytes, arrival.cut, arrival.loss, arrival.loss_seed}, diagnostics, limit);
    refused = !cloud;
    if (cloud) {
      const std::string url = net::url_of_path(std::filesystem::path(path).filename().string()).path;
      const vrml::NodeId node = add_cloud_shape(*scene, *cloud, url.substr(url.rfind('/') + 1));
      if (node) read.clouds[&scene->node(node)] = std::make_shared<const qnv::Cloud>(std::move(*cloud));
    }
  }
  if (!refused) read.scene = std::move(scene);
  return read;
}

}  // namespace gs::app
