#pragma once

#include "bench/transfer/link_emulator.h"
#include "net/cells/cell_receiver.h"
#include "qnv/base/geometry.h"
#include "render/scene/render_list.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::bench {

/// Measured server: `ghostspace serve`, a process on the server's host.
struct ServerSpec {
  std::string program;                 // path of ghostspace
  std::string folder;                  // served folder
  std::string scratch;                 // own folder for its cache
  std::vector<std::string> arguments;  // further arguments
};

/// One transfer of one file.
struct TransferSpec {
  LinkSpec link;
  std::string congestion_control = "cubic";  // for TCP
  std::string file;                          // in the served folder
  std::uint64_t size = 0;                    // in bytes
  bool cells = false;                        // otherwise HTTP
  bool one_range = false;                    // requested as one range
  double limit = 60;                         // seconds; later data count as missing
  std::uint64_t enough = 0;                  // stops after this number of bytes; 0 means all
};

/// Number of bytes received from the start of the file, with its time.
struct Arrival {
  double seconds = 0;
  std::uint64_t bytes = 0;
};

/// Receipt of a base or of a piece of a chunk.
struct CellArrival {
  double seconds = 0;
  net::CellEvent event;
};

/// Received data with their times, in seconds since the request, before there was a connection.
struct Recording {
  std::string problem;              // reason for a missing measurement
  std::string failure;              // reason why the client gave up; the time continues to the limit
  bool complete = false;            // everything is received; cells: the server has sent everything
  std::optional<double> connected;  // arrival of the server's first packet
  std::vector<Arrival> arrivals;    // over HTTP
  std::vector<CellArrival> cells;
  net::CellClientStatistics cell_counts;
  LinkCounts link;

  /// Returns the time of the last byte.
  [[nodiscard]] double last() const;
  /// Returns the time at which the first `bytes` of the file were complete, over HTTP.
  [[nodiscard]] std::optional<double> when(std::uint64_t bytes) const;
};

/// Makes a link and a server, and fetches the file. Any thread; several at once.
[[nodiscard]] Recording transfer(const TransferSpec& spec, const ServerSpec& server);

/// Reports whether `ghostspace serve` has an option.
[[nodiscard]] bool serve_has_option(const std::string& program, const std::string& option);

/// Decodes a stream from pieces received as cells. Returns an empty geometry before the base.
[[nodiscard]] qnv::Geometry geometry_of(std::span<const CellArrival> arrivals);
/// Draws the pieces as vectors, or as polygons for a stream of outlines.
[[nodiscard]] render::RenderList list_of(std::span<const CellArrival> arrivals);

}  // namespace gs::bench
