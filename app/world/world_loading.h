#pragma once

#include "app/base/load_limit.h"
#include "app/world/arrivals.h"
#include "app/world/opened_world.h"
#include "app/world/world_loader.h"
#include "net/cells/cell_receiver.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// How far the reading of a world is.
struct LoadingState {
  std::uint64_t received = 0;          // bytes of all files
  std::optional<std::uint64_t> total;  // of those that are being read; none while it is not known
  std::size_t files = 0;               // read or being read
  std::size_t waiting = 0;             // of these, not at their end
  friend bool operator==(const LoadingState&, const LoadingState&) = default;
};

/// Reads a world and all that it refers to (EXTERNPROTOs, Inlines, textures, QNV streams), from files and from the
/// network, side by side. What has come stands in the world at once: shapes before their file ends, long number lists
/// before they end, coarse vectors before fine ones.
///
/// Belongs to one thread; what it hands out is plain data, or is moved. Safe for untrusted files and servers.
class WorldLoading {
 public:
  /// `asked`: a path or URL.
  WorldLoading(const std::string& asked, const LoadOptions& options);
  ~WorldLoading();
  WorldLoading(const WorldLoading&) = delete;
  WorldLoading& operator=(const WorldLoading&) = delete;

  /// Takes in some of what has come, or waits for it, at most for `wait`. False when the world is done: everything is
  /// there, or will never be.
  bool step(std::chrono::milliseconds wait);
  [[nodiscard]] bool done() const;
  /// Ends the wait of a `step`. Any thread.
  void wake();

  /// Whether all nodes of the file itself are there, so that it can be taken while Inlines, EXTERNPROTOs, polygons,
  /// pictures and vectors still come.
  [[nodiscard]] bool root_is_read() const;
  /// After `take`: what has come since the last time.
  [[nodiscard]] Arrivals take_arrivals();
  /// After `take`: urls have been set. `step` until it is done again; what they name is among the arrivals, each Inline
  /// when its file is read.
  void request(std::vector<UrlRequest> requests);
  /// Waits for `wake`, at most for `wait`.
  void rest(std::chrono::milliseconds wait);
  /// After `take`: how large what waits is seen; nodes of `wanted`.
  void prioritize(std::unordered_map<const vrml::Node*, float> importance);
  /// The nodes for which something is still to come over the network.
  [[nodiscard]] std::unordered_set<const vrml::Node*> wanted() const;

  /// Whether something that shows has changed since the last `collect`.
  [[nodiscard]] bool changed() const;
  /// What is there, seen from `viewer`. Empty before there is anything.
  [[nodiscard]] render::RenderList collect(const glm::dvec3& viewer);
  /// From where the world is looked at: what is nearest and largest there comes first.
  void look_from(const glm::dvec3& viewer);

  [[nodiscard]] LoadingState state() const;
  /// Of streams that grow: what the thread that draws gives them; see stream_feed.h.
  [[nodiscard]] const std::vector<std::shared_ptr<StreamFeed>>& feeds() const;
  /// What is wrong so far.
  [[nodiscard]] const vrml::Diagnostics& diagnostics() const;
  /// Of the world, or the name of its file.
  [[nodiscard]] const std::string& title() const;
  /// How it stands; `size`: of all that it shows.
  [[nodiscard]] Upright upright(const glm::vec3& size) const;
  /// Whether it is a world with a look of its own; see OpenedWorld.
  [[nodiscard]] bool authored() const;
  /// The world as it is now; call once, when it is done or its root is read. What comes later are arrivals:
  /// the scene is not touched any more. Meshes that `collect` made go along.
  [[nodiscard]] OpenedWorld take(render::MeshCache* meshes = nullptr);

  /// Datagrams of cells that came, and that were lost.
  [[nodiscard]] net::CellClientStatistics cells() const;

  /// After `take`: whether streams are left whose finer vectors still come, as views ask for them. Then `step` goes
  /// on being of use, and touches nothing of the world but the streams.
  [[nodiscard]] bool streaming() const;
  /// Whether bytes of such streams have come since the last call.
  [[nodiscard]] bool streams_grew();

  /// The inside; see world_loading_state.h.
  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
