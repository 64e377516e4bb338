#include "bench/transfer/tables.h"
#include "net/files/file.h"
#include "qnv/reader/stream_decoder.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <utility>

namespace gs::bench {
namespace {

constexpr double kMegabits = 10, kRoundTrip = 0.1;
constexpr std::uint64_t kEnough = 300'000;  // bytes that contain a first picture

Box bounds_of(const Box& box) {
  Box bounds;
  bounds.add(box.lower);
  bounds.add(box.upper);
  return bounds;
}

bool shows(Studio& studio, const qnv::Geometry& geometry) {
  if (geometry.size() == 0) return false;
  const View view;
  const auto pictures = studio.pictures(list_of(geometry), bounds_of(geometry.description().box), std::span(&view, 1));
  return !pictures.empty() && std::any_of(pictures[0].pixels.begin(), pictures[0].pixels.end(),
                                          [](std::uint8_t value) { return value != 0; });
}

std::optional<std::uint64_t> first_bytes(Studio& studio, std::span<const std::byte> front) {
  const auto holds = [&](std::uint64_t bytes) {
    qnv::StreamDecoder decoder;
    (void)decoder.push(front.first(static_cast<std::size_t>(bytes)));
    return shows(studio, decoder.geometry());
  };
  if (!holds(front.size())) return std::nullopt;
  return least(1, front.size(), 1, holds);
}

struct First {
  double seconds = 0;
  std::uint64_t bytes = 0;  // required bytes
};

std::optional<First> first_of_cells(Studio& studio, const Recording& recording) {
  const auto holds = [&](std::uint64_t pieces) {
    return shows(studio, geometry_of(std::span(recording.cells).first(static_cast<std::size_t>(pieces))));
  };
  const std::uint64_t all = recording.cells.size();
  if (all == 0 || !holds(all)) return std::nullopt;
  const auto pieces = static_cast<std::size_t>(least(1, all, 1, holds));
  First first{recording.cells[pieces - 1].seconds, 0};
  for (const CellArrival& arrival : std::span(recording.cells).first(pieces)) first.bytes += arrival.event.bytes.size();
  return first;
}

}  // namespace

bool print_archive(const TransferOptions& options, Studio& studio, const ServerSpec& server) {
  namespace fs = std::filesystem;
  const auto file = net::map_file(options.archive);
  const auto* mapped = std::get_if<net::MappedFile>(&file);
  if (!mapped) {
    std::fprintf(stderr, "transfer: %s\n", std::get<net::FileError>(file).message.c_str());
    return false;
  }
  const auto front = mapped->bytes().first(std::min<std::size_t>(mapped->bytes().size(), kEnough));
  const auto bytes = first_bytes(studio, front);
  ServerSpec own = server;
  own.folder = fs::absolute(options.archive).parent_path().string();
  TransferSpec spec;
  spec.link.bits_per_second = kMegabits * 1e6;
  spec.link.round_trip = kRoundTrip;
  spec.link.seed = options.seed;
  spec.congestion_control = options.tcp;
  spec.file = fs::path(options.archive).filename().string();
  spec.size = mapped->bytes().size();
  spec.enough = kEnough;
  std::printf("#### First picture of a stream of %.1f MB, %g Mbit/s, %g ms\n\n", static_cast<double>(spec.size) / 1e6,
              kMegabits, kRoundTrip * 1e3);
  std::printf(
      "| | connected after, ms | first picture, ms after that | in round trips | bytes needed |\n"
      "|---|--:|--:|--:|--:|\n");
  bool good = true;
  for (const bool cells : {false, true}) {
    spec.cells = cells;
    const Recording recording = transfer(spec, own);
    std::optional<First> first;
    if (cells)
      first = first_of_cells(studio, recording);
    else if (const auto seconds = bytes ? recording.when(*bytes) : std::nullopt)
      first = First{*seconds, *bytes};
    good = good && first && recording.connected;
    if (!first || !recording.connected) {
      std::fprintf(stderr, "transfer: no picture of the archive: %s%s\n", recording.problem.c_str(),
                   recording.failure.c_str());
      continue;
    }
    const double after = first->seconds - *recording.connected;
    std::printf("| %s | %.0f | %.0f | %.2f | %llu |\n", cells ? "cells" : "HTTP, front to back",
                *recording.connected * 1e3, after * 1e3, after / kRoundTrip,
                static_cast<unsigned long long>(first->bytes));
  }
  std::printf("\n");
  std::fflush(stdout);
  return good;
}

}  // namespace gs::bench
