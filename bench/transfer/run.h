#pragma once

#include "bench/transfer/link_emulator.h"
#include "net/cells/cell_receiver.h"
#include "qnv/base/cloud.h"
#include "render/scene/render_list.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::bench {

/// The server that is measured: `ghostspace serve`, a process on the server's host.
struct ServerSpec {
  std::string program;                 // ghostspace
  std::string folder;                  // that is served
  std::string scratch;                 // a folder of its own, for its cache
  std::vector<std::string> arguments;  // more of them
};

/// One transfer of one file.
struct TransferSpec {
  LinkSpec link;
  std::string congestion_control = "cubic";  // TCP's
  std::string file;                          // in the served folder
  std::uint64_t size = 0;                    // of it
  bool cells = false;                        // else HTTP
  bool one_range = false;                    // asked for as one range of bytes
  double limit = 60;                         // seconds; what has not come by then never comes
  std::uint64_t enough = 0;                  // bytes; stops when so many have come; 0: everything
};

/// So many bytes from the start of the file had come.
struct Arrival {
  double seconds = 0;
  std::uint64_t bytes = 0;
};

/// A base or a piece of a chunk came.
struct CellArrival {
  double seconds = 0;
  net::CellEvent event;
};

/// Received data with their times, in seconds since the request, before there was a connection.
struct Recording {
  std::string problem;              // why nothing was measured
  std::string failure;              // why the loader, or the client of cells, gave up; the time goes on to the limit
  bool complete = false;            // all that was wanted has come; cells: the server has sent all
  std::optional<double> connected;  // the server's first packet reached the client
  std::vector<Arrival> arrivals;    // of HTTP
  std::vector<CellArrival> cells;
  net::CellClientStatistics cell_counts;
  LinkCounts link;

  /// When the last byte came.
  [[nodiscard]] double last() const;
  /// When the first so many bytes of the file were there, of HTTP.
  [[nodiscard]] std::optional<double> when(std::uint64_t bytes) const;
};

/// Makes a link and a server of its own, and fetches the file. Any thread; several at once.
[[nodiscard]] Recording transfer(const TransferSpec& spec, const ServerSpec& server);

/// Whether `ghostspace serve` has an option.
[[nodiscard]] bool serve_has_option(const std::string& program, const std::string& option);

/// The vectors of a stream of which these pieces came by cells; nothing before the base has come.
[[nodiscard]] qnv::Cloud cloud_of(std::span<const CellArrival> arrivals);
/// The same, or polygons where it is a stream of outlines.
[[nodiscard]] render::RenderList list_of(std::span<const CellArrival> arrivals);

}  // namespace gs::bench
