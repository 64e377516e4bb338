#include "app/world/world_loading.h"

#include "app/base/local_file.h"
#include "app/world/importance.h"
#include "app/world/outline_handler.h"
#include "app/world/scene_handler.h"
#include "base/text.h"
#include "net/base/schemes.h"
#include "net/files/standard_input.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

std::string title_of(const vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.node_count(); ++i) {
    const vrml::NodeId id = scene.id_at(i);
    const vrml::Node& node = scene.node_at(i);
    if (node.in_prototype_body || node.type->read_as != vrml::NodeKind::world_info) continue;
    std::string title = scene.get<vrml::SFString>(id, "title").str();
    if (!title.empty()) return title;
  }
  return {};
}

}  // namespace

WorldLoading::State::State(const std::string& asked, const LoadOptions& given)
    : options(given),
      ledger(given.ledger ? given.ledger : std::make_shared<LoadLedger>()),
      limit(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(std::clamp(given.timeout_seconds, 0.0, 1e6))),
            given.cancelled),
      budget(std::make_shared<Budget>(given.limits)) {
  budget->stop_when([time = limit] { return time.over(); });
  world.path = asked;
  world.title = file_name(asked);
  world.network_allowed = given.allow_network;
}

WorldLoading::State::~State() { ledger->set_wake({}); }

void WorldLoading::State::start() {
  ledger->set_wake([waker = waker] { waker->wake(); });
  const net::Url asked = net::parse_url(world.path);
  root = std::make_shared<SceneHandler>(*this, SceneHandler::Role::root, nullptr);
  auto first = std::make_unique<Fetch>();
  if (asked.scheme.empty() || asked.scheme == "file") {
    const std::string path = asked.scheme.empty() ? world.path : net::path_of_url(asked);
    std::error_code error;
    // A text on standard input refers to files in the working directory.
    const std::string place = path == net::kStandardInputPath ? "stdin" : path;
    const std::filesystem::path absolute = std::filesystem::absolute(place, error);
    first->candidates = {net::url_of_path(error ? place : absolute.lexically_normal().string())};
    first->given_path = path;
    policy = policy_of_world(place, options.allowed);
  } else {
    first->candidates = {asked};
  }
  first->max_bytes = options.max_bytes;
  first->handler = root;
  fetch(std::move(first), Urgency::world);
}

void WorldLoading::State::stop(const std::string& why) {
  if (std::exchange(phase, Phase::stopped) == Phase::stopped) return;
  const bool cancelled = limit.cancelled && *limit.cancelled;
  if (!cancelled) report(Severity::error, root && root->scene ? root->scene->file_name() : world.path, {}, why);
  for (const auto& [id, fetch] : by_request) loader->cancel(fetch->request);
  by_request.clear();
  local.clear();
  // Keeps the received part of each fetch. New fetches are refused, because the phase is `stopped`.
  for (std::size_t i = 0; i < fetches.size(); ++i) {
    Fetch& fetch = *fetches[i];
    if (std::find(ended.begin(), ended.end(), &fetch) != ended.end()) continue;
    fetch.handler->cut = true;
    stop_cells(&fetch);
    if (fetch.stage == Fetch::Stage::receiving) fetch.handler->end(std::nullopt);
    if (fetch.handler == root && !root->refused()) root->content = SceneHandler::Content::cut_short;
    ledger->end(fetch.row, cancelled ? LoadStage::cancelled : LoadStage::failed, cancelled ? "" : why);
  }
  ended.clear();
  fetches.clear();
}

void WorldLoading::State::cancel_rows() {
  for (const std::uint64_t row : ledger->take_cancelled()) {
    for (const auto& stream : streams)
      if (stream->row() == row) stream->cancel();
    cancel_cells(row);
    const auto fetch = std::find_if(fetches.begin(), fetches.end(), [&](const auto& one) { return one->row == row; });
    if (fetch != fetches.end() && std::find(ended.begin(), ended.end(), fetch->get()) == ended.end()) cancel(**fetch);
  }
}

// Stops a fetch and keeps its received part.
void WorldLoading::State::cancel(Fetch& fetch) {
  std::erase(local, &fetch);
  stop_cells(&fetch);
  if (by_request.erase(fetch.request.value) > 0) loader->cancel(fetch.request);
  ended.push_back(&fetch);
  ledger->end(fetch.row, LoadStage::cancelled);
  fetch.handler->cut = true;
  if (fetch.stage == Fetch::Stage::receiving)
    fetch.handler->end(std::nullopt);
  else if (fetch.stage == Fetch::Stage::seeking)
    fetch.handler->missing("loading was cancelled");
  if (fetch.handler == root && !root->refused()) root->content = SceneHandler::Content::cut_short;
}

bool WorldLoading::State::step(std::chrono::milliseconds wait) {
  bool busy = false;
  cancel_rows();
  follow_rate();
  // Local files come first, so that something is visible even with a short time limit.
  if (!local.empty()) {
    local_step();
    busy = true;
  }
  if (!is_done() && !fetches.empty() && ended.size() < fetches.size() && limit.over())
    stop("the time limit for loading was reached; the missing parts are left out");
  if (phase == Phase::too_many_files)
    stop("refers to more than " + std::to_string(budget->limits().files) + " files; the rest is left out");
  if (is_done() && streams.empty() && cells.empty()) return false;
  if (loader) busy = take_events() || busy;
  busy = step_cells() || busy;
  for (const auto& stream : streams) busy = stream->ask_for_more() || busy;
  std::erase_if(streams, [](const auto& stream) { return stream->over(); });
  for (Fetch* fetch : std::exchange(ended, {}))
    std::erase_if(fetches, [fetch](const auto& one) { return one.get() == fetch; });
  const bool ends_now = !is_done() && fetches.empty();
  if (ends_now) phase = Phase::done;
  if (!busy && !is_done()) set_priorities();
  if (busy || ends_now || (is_done() && !taken)) return !is_done() || !streams.empty() || !cells.empty();
  waker->wait(std::min(wait, kLongestWait));
  return true;
}

void WorldLoading::State::cloud_arrived(Arrivals::Cloud cloud) {
  changed = true;
  if (const auto* mesh = cloud.cloud ? cloud.cloud->as<qnv::IndexedMesh>() : nullptr; mesh && mesh->picture)
    cloud.image = pictures.image_of(mesh->picture, budget);
  if (!taken) return set_cloud(world, cloud);
  for (Arrivals::Cloud& earlier : arrivals.clouds)
    if (earlier.place.scene == cloud.place.scene && earlier.place.node == cloud.place.node &&
        earlier.place.request == cloud.place.request) {
      earlier.cloud = std::move(cloud.cloud);
      earlier.image = std::move(cloud.image);
      return;
    }
  arrivals.clouds.push_back(std::move(cloud));
}

void WorldLoading::State::note_progress(const UrlProgress& progress) {
  std::vector<UrlProgress>& all = taken ? arrivals.progress : world.progress;
  for (UrlProgress& earlier : all)
    if (earlier.scene == progress.scene && earlier.node == progress.node) {
      earlier.fraction = progress.fraction;
      return;
    }
  all.push_back(progress);
}

void WorldLoading::State::outlines_arrived(Arrivals::Outlines arrival) {
  changed = true;
  if (taken) {
    arrivals.outlines.push_back(std::move(arrival));
    return;
  }
  set_outlines(world, arrival);
  if (SceneHandler* const handler = root->handler_of(arrival.place.scene))
    handler->outlines_changed(arrival.place.node);
}

void WorldLoading::State::give_outlines() {
  for (const auto& one : std::exchange(outlines, {})) one->give();
}

void WorldLoading::State::image_arrived(Arrivals::Image image) {
  changed = true;
  if (taken) {
    arrivals.images.push_back(std::move(image));
  } else if (image.image) {
    for (const Arrivals::Place& texture : image.textures)
      world.images[{&texture.scene->node(texture.node), texture.url}] = image.image;
  }
}

void WorldLoading::State::set_priorities() {
  if (!loader || by_request.empty() || !root || !root->scene) return;
  const auto now = Clock::now();
  if (now < next_priorities) return;
  next_priorities = now + std::chrono::milliseconds(200);
  if (!taken) {
    std::unordered_set<const vrml::Node*> wanted;
    for (const auto& [id, fetch] : by_request)
      if (fetch->node) wanted.insert(fetch->node);
    importance = importance_of(*root->scene, wanted, viewer);
  }
  for (const auto& [id, fetch] : by_request) {
    const auto known = importance.find(fetch->node);
    if (known == importance.end()) continue;
    const int size = static_cast<int>(std::clamp(known->second, 0.0f, 1.0f) * (kUrgencyStep - 1));
    const int priority = fetch->priority / kUrgencyStep * kUrgencyStep + size;
    if (priority == fetch->priority) continue;
    fetch->priority = priority;
    loader->set_priority(fetch->request, priority);
  }
}

// WorldLoading

WorldLoading::WorldLoading(const std::string& asked, const LoadOptions& options)
    : state_(std::make_unique<State>(asked, options)) {
  state_->start();
}
WorldLoading::~WorldLoading() = default;

bool WorldLoading::step(std::chrono::milliseconds wait) { return state_->step(wait); }
bool WorldLoading::done() const { return state_->is_done(); }
void WorldLoading::wake() { state_->waker->wake(); }
bool WorldLoading::root_is_read() const {
  const State& s = *state_;
  return s.root && s.root->scene && !s.root->refused() && !s.taken && s.root->nothing_more_comes();
}
Arrivals WorldLoading::take_arrivals() { return state_->take_arrivals(); }
void WorldLoading::request(std::vector<UrlRequest> requests) { state_->request(std::move(requests)); }
void WorldLoading::rest(std::chrono::milliseconds wait) { state_->waker->wait(wait); }
void WorldLoading::prioritize(std::unordered_map<const vrml::Node*, float> importance) {
  state_->importance = std::move(importance);
}
std::unordered_set<const vrml::Node*> WorldLoading::wanted() const {
  std::unordered_set<const vrml::Node*> wanted;
  for (const auto& [id, fetch] : state_->by_request)
    if (fetch->node) wanted.insert(fetch->node);
  return wanted;
}
bool WorldLoading::changed() const { return state_->changed; }
bool WorldLoading::streaming() const { return !state_->streams.empty() || !state_->cells.empty(); }
net::CellClientStatistics WorldLoading::cells() const { return state_->cell_statistics(); }
bool WorldLoading::streams_grew() { return std::exchange(state_->streams_grew, false); }
void WorldLoading::look_from(const glm::dvec3& viewer) { state_->viewer = viewer; }

render::RenderList WorldLoading::collect(const glm::dvec3& viewer) {
  State& s = *state_;
  s.give_outlines();
  s.changed = false;
  if (!s.root->scene || s.root->refused()) return {};
  s.root->forget_open(s.meshes);
  return render::collect(*s.root->scene, s.world.images, s.meshes, viewer, s.world.clouds);
}

LoadingState WorldLoading::state() const {
  LoadingState result;
  result.received = state_->received;
  result.files = state_->files;
  result.waiting = state_->fetches.size();
  std::uint64_t left = 0;
  bool known = true;
  for (const auto& fetch : state_->fetches) {
    known = known && fetch->total;
    if (fetch->total) left += std::max(*fetch->total, fetch->received) - fetch->received;
  }
  if (known) result.total = result.received + left;
  return result;
}

const Diagnostics& WorldLoading::diagnostics() const { return state_->world.diagnostics; }
const std::vector<std::shared_ptr<StreamFeed>>& WorldLoading::feeds() const { return state_->world.feeds; }
const std::string& WorldLoading::title() const { return state_->world.title; }
bool WorldLoading::authored() const { return state_->world.authored; }
Upright WorldLoading::upright(const glm::vec3& size) const { return state_->world.upright(size); }

OpenedWorld WorldLoading::take(render::MeshCache* meshes) {
  State& s = *state_;
  s.give_outlines();
  s.taken = true;
  s.budget->stop_when({});
  OpenedWorld world = std::exchange(s.world, OpenedWorld());
  s.world.path = world.path;
  s.world.title = world.title;
  world.bytes = s.root->bytes();
  world.parse_seconds = s.root->seconds();
  world.truncated = s.root->content == SceneHandler::Content::cut_short;
  world.scene = s.root->give_root();
  if (world.scene) {
    if (std::string title = title_of(*world.scene); !title.empty()) world.title = std::move(title);
    world.color_key = color_key_of(*world.scene);
  }
  if (meshes) {
    s.root->forget_open(s.meshes);
    *meshes = std::move(s.meshes);
  }
  s.meshes = {};
  return world;
}

}  // namespace gs::app
