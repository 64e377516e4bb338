#include "app/loading/world_loading.h"

#include "app/base/local_file.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/zarr/zarr_place.h"
#include "app/formats/streamed_names.h"
#include "app/formats/volume/volume.h"
#include "app/loading/content/outline_handler.h"
#include "app/loading/content/scene_handler.h"
#include "app/loading/fetch/importance.h"
#include "app/loading/fetch/loading.h"
#include "app/loading/listing/bucket_list.h"
#include "app/loading/listing/folder_choice.h"
#include "app/loading/updates/live_data.h"
#include "net/files/standard_input.h"
#include "net/serve/served_folder.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace gs::app {
namespace {

constexpr glm::dvec3 kViewer{0, 0, 10};  // assumed before the world runs

// Returns the URL of the stream that a server reached by ssh makes from a large file. It is the URL of the file with
// `extension` appended. Returns nullopt if the file itself must be read.
std::optional<net::Url> stream_of(const net::Url& url, const LoadOptions& options,
                                  std::string_view extension = kStreamExtension) {
  constexpr std::uint64_t kWorthEncoding = std::uint64_t{8} << 20;
  if (url.scheme != "ssh" || url.has_query || !(options.by_view || options.large_by_view)) return std::nullopt;
  const std::size_t slash = url.path.rfind('/') + 1;
  const std::string name = url.path.substr(slash);
  if (streamed_name(name) == name) return std::nullopt;
  net::Url stream = url;
  stream.path += extension;
  stream.has_query = true;
  stream.query = net::kLeastSizeQuery + std::to_string(kWorthEncoding);
  return stream;
}

// Returns the URLs of the lists for a folder (a URL with a slash at its end) or for a series of numbered files. Returns
// an empty list for other URLs.
std::vector<net::Url> lists_of(const net::Url& asked, const std::string& text) {
  const auto series = series_of_url(text);
  if (!series && !asked.path.ends_with('/')) return {};
  net::Url start = asked;
  if (series)
    start.path = net::parse_url(text.substr(0, text.rfind('/') + 1)).path + net::reference_of_path(series->before);
  std::vector<net::Url> lists;
  // Scans may have subfolders.
  for (const BucketPlace& place : bucket_places(start)) lists.push_back(list_url(place, series.has_value()));
  return lists;
}

}  // namespace

std::string coarse_url_of(const std::string& path, const LoadOptions& options) {
  const net::Url url = net::parse_url(path);
  const ContentType* const type = content_type_by_name(url.path);
  if (url.scheme != "ssh" || !type || type->content != ContentClass::volume || !zarr_entries_of_url(path).empty())
    return {};
  const auto stream = stream_of(url, options, kCoarseExtension);
  return stream ? stream->text() : std::string();
}

struct WorldLoading::State {
  State(const std::string& path, const LoadOptions& options);

  void start();
  [[nodiscard]] NetworkTransfers::Importance importance_of_nodes(const NetworkTransfers::Nodes& wanted);
  /// Adds received polygons of OutlineGroups to the results.
  void add_outlines();
  void give_contents();

  Loading loading;
  SceneContext context{loading};
  std::shared_ptr<SceneHandler> root;
  render::MeshCache meshes;
  NetworkTransfers::Importance importance;  // importance from the world's owner
};

WorldLoading::State::State(const std::string& path, const LoadOptions& options)
    : loading(path, options), root(std::make_shared<SceneHandler>(context, SceneUse{})) {
  loading.fetcher.network().set_importance([this](const auto& wanted) { return importance_of_nodes(wanted); });
}

void WorldLoading::State::start() {
  const std::string& asked_path = loading.results.path();
  const net::Url asked = net::parse_url(live_address(asked_path));
  auto first = std::make_unique<Fetch>();
  if (asked.scheme.empty() || asked.scheme == "file") {
    std::string path = asked.scheme.empty() ? asked_path : net::path_of_url(asked);
    if (std::string file = file_of_folder(path); !file.empty())
      path = std::move(file);
    else if (std::string scan = entry_of_folder(path); !scan.empty())
      loading.options.component.folder = std::exchange(path, std::move(scan));
    std::error_code error;
    // A world from standard input resolves references in the working directory.
    const std::string place = path == net::kStandardInputPath ? "stdin" : path;
    const std::filesystem::path absolute = std::filesystem::absolute(place, error);
    first->candidates = {net::url_of_path(error ? place : absolute.lexically_normal().string())};
    first->given_path = path;
    loading.fetcher.set_policy(policy_of_world(place, loading.options.allowed));
  } else {
    for (const std::string& entry : zarr_entries_of_url(asked_path)) first->candidates.push_back(net::parse_url(entry));
    first->together = first->candidates;
    if (!first->together.empty()) {
      net::Url consolidated = first->together.front();
      consolidated.path = consolidated.path.substr(0, consolidated.path.rfind('/') + 1) + ".zmetadata";
      first->together.push_back(std::move(consolidated));
    }
    net::ReferencePolicy policy;
    if (asked.scheme == "ssh") policy.allow_ssh(asked);
    if (first->candidates.empty()) {
      const std::vector<net::Url> lists = lists_of(asked, asked_path);
      if (lists.empty() || !series_of_url(asked_path)) first->candidates = {asked};
      first->candidates.insert(first->candidates.end(), lists.begin(), lists.end());
      if (const auto stream = stream_of(asked, loading.options)) {
        first->candidates.insert(first->candidates.begin(), *stream);
        first->optional = 1;
      }
    }
    loading.fetcher.set_policy(std::move(policy));
  }
  first->max_bytes = loading.options.max_bytes;
  first->handler = root;
  first->refresh = loading.options.component.growing;
  loading.fetcher.fetch(std::move(first), Urgency::world);
}

NetworkTransfers::Importance WorldLoading::State::importance_of_nodes(const NetworkTransfers::Nodes& wanted) {
  if (!loading.results.is_handed_over() && root->target().scene())
    importance = importance_of(*root->target().scene(), wanted, kViewer);
  return importance;
}

void WorldLoading::State::add_outlines() {
  for (const auto& one : std::exchange(context.outlines, {})) {
    one->give();
    if (loading.results.is_handed_over()) continue;
    if (SceneHandler* const handler = handler_of(*root, one->group().scene))
      handler->target().node_changed(one->group().node);
  }
}

// Gives the contents of the withheld Inlines with complete files. The drawing thread gets their meshes, too. Giving a
// content appends its inner Inlines to the list.
void WorldLoading::State::give_contents() {
  auto& withheld = context.withheld;
  for (std::size_t i = 0; i < withheld.size();) {
    const std::shared_ptr<SceneHandler> one = withheld[i];
    if (!one->nothing_more_comes() && loading.fetcher.reads_for(*one)) {
      ++i;
      continue;
    }
    withheld.erase(withheld.begin() + static_cast<std::ptrdiff_t>(i));
    ResourceUpdates::Content content{one->use().request.place, give_content(*one, context), {}};
    if (content.content) (void)render::collect(*content.content, {}, content.meshes, kViewer, {});
    loading.results.add(std::move(content));
  }
}

WorldLoading::WorldLoading(const std::string& asked, const LoadOptions& options)
    : state_(std::make_unique<State>(asked, options)) {
  state_->start();
}
WorldLoading::~WorldLoading() = default;

bool WorldLoading::step(std::chrono::milliseconds wait) { return state_->loading.fetcher.step(wait); }
bool WorldLoading::done() const { return state_->loading.fetcher.is_done(); }
void WorldLoading::wake() { state_->loading.waker->wake(); }
void WorldLoading::rest(std::chrono::milliseconds wait) { state_->loading.waker->wait(wait); }

bool WorldLoading::root_is_read() const {
  const SceneHandler& root = *state_->root;
  return root.target().scene() && !root.target().refused() && !state_->loading.results.is_handed_over() &&
         root.nothing_more_comes();
}

ResourceUpdates WorldLoading::take_updates() {
  State& s = *state_;
  s.add_outlines();
  s.give_contents();
  return s.loading.results.take_updates([&](const vrml::SceneGraph* scene) {
    return std::any_of(s.context.withheld.begin(), s.context.withheld.end(),
                       [&](const auto& one) { return handler_of(*one, scene) != nullptr; });
  });
}

void WorldLoading::request(std::vector<UrlRequest> requests) {
  State& s = *state_;
  if (!s.loading.results.is_handed_over()) return;
  s.loading.limit = limit_of(s.loading.options);
  s.loading.fetcher.restart();
  for (const UrlRequest& one : requests)
    if (SceneHandler* const handler = handler_of(*s.root, one.place.scene)) handler->references().load(one);
}

void WorldLoading::prioritize(std::unordered_map<const vrml::Node*, float> importance) {
  state_->importance = std::move(importance);
}
std::unordered_set<const vrml::Node*> WorldLoading::wanted() const {
  return state_->loading.fetcher.network().wanted();
}
bool WorldLoading::changed() const { return state_->loading.results.changed(); }
bool WorldLoading::streaming() const { return state_->loading.fetcher.has_streams(); }
bool WorldLoading::streams_rest() const {
  Fetcher& fetcher = state_->loading.fetcher;
  return fetcher.network().streams_rest() && fetcher.cells().streams_rest();
}
net::CellClientStatistics WorldLoading::cells() const { return state_->loading.fetcher.cells().statistics(); }
bool WorldLoading::streams_grew() { return state_->loading.fetcher.network().take_growth(); }

render::RenderList WorldLoading::collect(const glm::dvec3& viewer) {
  State& s = *state_;
  s.add_outlines();
  LoadResults& results = s.loading.results;
  results.set_changed(false);
  SceneHandler& root = *s.root;
  if (!root.target().scene() || root.target().refused() || results.is_handed_over()) return {};
  forget_open(root, s.meshes);
  return render::collect(*root.target().scene(), results.world()->images, s.meshes, viewer,
                         results.world()->geometries);
}

LoadingState WorldLoading::state() const { return state_->loading.fetcher.state(); }
const Diagnostics& WorldLoading::diagnostics() const { return state_->loading.results.diagnostics(); }
const std::vector<std::shared_ptr<StreamFeed>>& WorldLoading::feeds() const { return state_->loading.results.feeds(); }
const std::string& WorldLoading::title() const { return state_->loading.results.title(); }

bool WorldLoading::authored() const {
  const LoadedWorld* world = state_->loading.results.world();
  return !world || world->authored;
}

Upright WorldLoading::upright(const glm::vec3& size) const {
  const LoadedWorld* world = state_->loading.results.world();
  return world ? world->upright(size) : Upright{};
}

LoadedWorld WorldLoading::take(render::MeshCache* meshes) {
  State& s = *state_;
  s.add_outlines();
  s.loading.budget->stop_when({});
  if (meshes) {
    forget_open(*s.root, s.meshes);
    *meshes = std::move(s.meshes);
  }
  s.meshes = {};
  LoadedWorld world = s.loading.results.hand_over(give_root(*s.root, s.context));
  world.bytes = s.root->bytes();
  world.parts = s.root->parts();
  world.parse_seconds = s.root->seconds();
  world.truncated = s.root->target().content() == SceneTarget::Content::cut_short;
  return world;
}

}  // namespace gs::app
