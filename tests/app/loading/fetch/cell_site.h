#pragma once

// Helpers of tests of cells over UDP.
#include "app/loading/world_loading.h"
#include "app/serve/archive.h"
#include "app/streams/cell_regions.h"
#include "app/streams/stream_feed.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/records/encode/encode_vectors.h"
#include "qnv/codecs/shared/encode_options.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/large_stream.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"
#include "tests/qnv/surface_shapes.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

using test::string_of;

inline constexpr std::chrono::milliseconds kCellWait{20};

/// Returns a stream of records of a coloured ball.
inline const std::string& records_stream() {
  static const std::string bytes = [] {
    qnv::EncodeOptions options;
    const auto encoded = qnv::encode_vectors(test::sphere(30'000), options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
  }();
  return bytes;
}

/// Returns a stream of a ball far from the origin, so version 2. It ends with the exact mesh.
inline const std::string& exact_stream() {
  static const std::string bytes = [] {
    qnv::EncodeOptions options;
    options.exact_bits = 12;
    options.origin = {6e6, 2e6, -3e6};
    const auto encoded = qnv::encode_displaced(qnv::source_of(qnv::sphere(40)), options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
  }();
  return bytes;
}

/// Archive of cells in a temporary folder.
struct CellSite {
  ScratchFolder folder;
  std::unique_ptr<Archive> archive;
  ArchiveOptions options;

  CellSite() {
    folder.write("packed.qnv", large_stream());
    folder.write("records.qnv", records_stream());
    folder.write("exact.qnv", exact_stream());
    folder.write("world.wrl", "#VRML V2.0 utf8\nShape { geometry Box {} }\n");
    options.folder = folder.path("");
    options.cells_port = 0;
    options.log = "";
  }
  void start() {
    auto started = Archive::start(options);
    if (const auto* problem = std::get_if<std::string>(&started)) FAIL(*problem);
    archive = std::move(std::get<std::unique_ptr<Archive>>(started));
    options.cells_port = archive->cells_port();
  }
  [[nodiscard]] std::string url(const std::string& name) const {
    return "cells://127.0.0.1:" + std::to_string(*options.cells_port) + "/" + name;
  }
};

inline qnv::Geometry geometry_of_world(const LoadedWorld& world) {
  REQUIRE(world.geometries.size() == 1);
  const auto& geometry = *world.geometries.begin()->second;
  const auto* octree = geometry.as<qnv::OctreeSplats>();
  return octree ? octree->stream->whole() : geometry;
}

/// Returns position and weight of each splat, sorted.
inline std::vector<std::array<float, 4>> discs_of(const qnv::VectorView& geometry) {
  std::vector<std::array<float, 4>> all;
  for (std::size_t i = 0; i < geometry.size(); ++i)
    all.push_back({geometry.positions[i].x, geometry.positions[i].y, geometry.positions[i].z, geometry.weights[i]});
  std::sort(all.begin(), all.end());
  return all;
}

inline double total_of(const qnv::VectorView& geometry) {
  double total = 0;
  for (const float weight : geometry.weights) total += weight;
  return total;
}

inline bool tells(const Diagnostics& diagnostics, const std::string& text) {
  return std::any_of(diagnostics.entries().begin(), diagnostics.entries().end(),
                     [&](const Diagnostic& one) { return one.message.find(text) != std::string::npos; });
}

}  // namespace gs::app
