#include "app/commands/fetch.h"

#include "app/base/console.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/shared.h"
#include "app/loading/world_loading.h"
#include "app/streams/stream_feed.h"
#include "base/json_value.h"
#include "net/base/schemes.h"
#include "net/base/url.h"

#include <algorithm>
#include <chrono>
#include <string>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxCounted = std::size_t{1} << 30;  // Gaussians

/// Measurements of one fetch.
struct Report {
  std::uint64_t bytes = 0, first_bytes = 0;
  double seconds = 0, first_seconds = -1;  // in seconds; first_seconds is -1 if nothing could be drawn
  std::uint64_t vectors = 0, triangles = 0;
  bool is_cells = false, complete = true;
  net::CellClientStatistics cells;
};

bool comes_as_cells(const std::string& url) {
  const net::Scheme* scheme = net::find_scheme(net::parse_url(url).scheme);
  return scheme && scheme->transport == net::TransportKind::cells;
}

bool apply(const WorldLoading& loading) {
  bool any = false;
  for (const auto& feed : loading.feeds()) any = feed->apply() || any;
  return any;
}

bool shows(const render::RenderList& list) {
  return !list.items.empty() || std::any_of(list.splats.begin(), list.splats.end(), [](const render::SplatItem& item) {
    const auto* octree = item.geometry ? item.geometry->as<qnv::OctreeSplats>() : nullptr;
    const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
    if (gaussians && gaussians->stream) return gaussians->stream->statistics().clusters > 0;
    return octree ? octree->stream->statistics().clusters > 0 : item.geometry && item.geometry->size() > 0;
  });
}

void count(LoadedWorld& world, Report& report) {
  for (const auto& [node, geometry] : world.geometries) {
    const auto* octree = geometry->as<qnv::OctreeSplats>();
    const auto* gaussians = geometry->as<qnv::Gaussians>();
    if (gaussians && gaussians->stream)
      report.vectors += gaussians->stream->whole().decode(kMaxCounted).size();
    else
      report.vectors += octree ? octree->stream->count() : geometry->size();
  }
  render::MeshCache meshes;
  const render::RenderList list = render::collect(*world.scene, world.images, meshes, {0, 0, 10}, world.geometries);
  for (const auto& item : list.items)
    if (item.mesh) report.triangles += item.mesh->indices.size() / 3;
}

JsonValue facts_of(const std::string& url, const Report& report) {
  JsonValue facts =
      JsonValue::named({{"url", net::url_for_messages(url)},
                        {"bytes", report.bytes},
                        {"seconds", report.seconds},
                        {"vectors", report.vectors},
                        {"triangles", report.triangles},
                        {"first_picture_s", report.first_seconds < 0 ? JsonValue() : JsonValue(report.first_seconds)},
                        {"first_picture_bytes", report.first_bytes},
                        {"complete", report.complete}});
  if (report.is_cells)
    facts.put("cells",
              JsonValue::named({{"datagrams", report.cells.datagrams},
                                {"lost_datagrams", report.cells.lost},
                                {"parity_datagrams", report.cells.parity},
                                {"rebuilt_datagrams", report.cells.rebuilt},
                                {"damaged_pdus", report.cells.damaged_pdus},
                                {"granted_bit_s", report.cells.granted},
                                {"rate_bit_s", report.cells.server_rate},
                                {"round_trip_ms", static_cast<double>(report.cells.round_trip.count()) / 1000}}));
  return facts;
}

void print(const Report& report) {
  const double rate = report.seconds > 0 ? static_cast<double>(report.bytes) * 8e-6 / report.seconds : 0;
  print_line("%llu bytes in %.3f s (%.3f Mbit/s)%s", static_cast<unsigned long long>(report.bytes), report.seconds,
             rate, report.complete ? "" : "; incomplete");
  if (report.first_seconds < 0)
    print_line("nothing to show");
  else
    print_line("first picture after %.3f s and %llu bytes", report.first_seconds,
               static_cast<unsigned long long>(report.first_bytes));
  print_line("%llu vectors, %llu triangles", static_cast<unsigned long long>(report.vectors),
             static_cast<unsigned long long>(report.triangles));
  if (!report.is_cells) return;
  const std::uint64_t sent = report.cells.datagrams + report.cells.lost;
  print_line("%llu cell datagrams received, %llu lost (%.2f %%), %llu of them restored, %llu PDUs damaged",
             static_cast<unsigned long long>(report.cells.datagrams),
             static_cast<unsigned long long>(report.cells.lost),
             sent > 0 ? 100.0 * static_cast<double>(report.cells.lost) / static_cast<double>(sent) : 0.0,
             static_cast<unsigned long long>(report.cells.rebuilt),
             static_cast<unsigned long long>(report.cells.damaged_pdus));
  print_line("granted %.3f Mbit/s, round trip %.1f ms", static_cast<double>(report.cells.granted) * 1e-6,
             static_cast<double>(report.cells.round_trip.count()) / 1000);
}

}  // namespace

std::optional<std::string> check_fetch(const FetchCommand& options) {
  if (options.loss > 0 && !comes_as_cells(options.files.front()))
    return "--loss: only cells are lost, because other transports retransmit; expected a cells: URL";
  return std::nullopt;
}

int run_fetch(const FetchCommand& options) {
  const std::string& url = options.files.front();
  LoadOptions load = load_options(options);
  load.whole_surfaces = true;  // the report counts vectors, which patches do not have
  load.cache_folder.clear();  // the report must measure transfers, not the cache
  Report report;
  report.is_cells = comes_as_cells(url);
  ProgressBar progress;
  progress.whole().stage = "fetching";
  load.cancelled = &progress.whole().cancelled;

  const Clock::time_point start = Clock::now();
  const auto seconds = [start] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  WorldLoading loading(url, load);
  bool more = false;
  while (!loading.done()) {
    (void)loading.step(std::chrono::milliseconds(100));
    const LoadingState state = loading.state();
    progress.whole().total = state.total.value_or(0);
    progress.whole().done = state.received;
    more = apply(loading) || loading.changed() || more;
    if (report.first_seconds >= 0 || !more) continue;
    more = false;
    if (!shows(loading.collect({0, 0, 10}))) continue;
    report.first_seconds = seconds();
    report.first_bytes = state.received;
  }
  report.seconds = seconds();
  report.bytes = loading.state().received;
  report.cells = loading.cells();
  const bool cancelled = progress.cancelled();
  LoadedWorld world = loading.take();
  print_diagnostics(world.diagnostics);
  if (!world.scene || cancelled) return kFailed;
  report.complete = !world.truncated && world.diagnostics.errors() == 0;
  count(world, report);
  if (options.json)
    print_text(facts_of(url, report).json());
  else
    print(report);
  return report.complete ? kDone : kFailed;
}

}  // namespace gs::app
