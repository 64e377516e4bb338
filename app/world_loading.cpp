#include "app/world_loading.h"

#include "app/importance.h"
#include "app/local_file.h"
#include "app/world_loading_state.h"
#include "net/schemes.h"
#include "net/transport.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;
using vrml::Severity;

constexpr std::size_t kMaxFiles = 20'000;                         // of all kinds, one world
constexpr std::size_t kPiece = std::size_t{4} << 20;              // of a local file, between two looks at the clock
constexpr std::chrono::milliseconds kLongestWait{1000};           // so that a limit is noticed
constexpr std::uint64_t kFront = std::uint64_t{1} << 16;          // of a long stream, before views choose
constexpr std::uint64_t kWorthChoosing = std::uint64_t{1} << 20;  // shorter ones are simply read
constexpr int kUrgencyStep = 1000;  // of priorities; below it, how large something is seen

std::string without_fragment(net::Url url) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text();
}

std::string title_of(const vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.node_count(); ++i) {
    const vrml::NodeId id = scene.id_at(i);
    const vrml::Node& node = scene.node(id);
    if (node.in_prototype_body || node.type->name != "WorldInfo" || node.type->kind != vrml::NodeType::Kind::built_in)
      continue;
    std::string title = scene.get<vrml::SFString>(id, "title").str();
    if (!title.empty()) return title;
  }
  return {};
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace

WorldLoading::State::State(const std::string& asked, const LoadOptions& given)
    : options(given),
      limit(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(std::clamp(given.timeout_seconds, 0.0, 1e6))),
            given.cancelled) {
  world.path = asked;
  world.title = file_name(asked);
}

WorldLoading::State::~State() = default;

void WorldLoading::State::start() {
  const net::Url asked = net::parse_url(world.path);
  root = std::make_shared<SceneTaker>(*this, SceneTaker::Role::root, nullptr);
  auto first = std::make_unique<Fetch>();
  if (asked.scheme.empty() || asked.scheme == "file") {
    const std::string path = asked.scheme.empty() ? world.path : net::path_of_url(asked);
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(path, error);
    first->candidates = {net::url_of_path(error ? path : absolute.lexically_normal().string())};
    first->given_path = path;
  } else {
    first->candidates = {asked};
  }
  first->max_bytes = options.max_bytes;
  first->taker = root;
  fetch(std::move(first), Urgency::world);
}

std::vector<net::Url> WorldLoading::State::candidates(const vrml::MFString& urls,
                                                      const std::vector<net::Url>& bases) const {
  std::vector<net::Url> found;
  std::unordered_set<std::string> seen;
  for (const vrml::SFString& url : urls) {
    const net::Url parsed = net::parse_url(net::tidy_url(url.view()));
    for (const net::Url& base : bases) {
      net::Url resolved = net::resolve(base, parsed);
      if (seen.insert(resolved.text()).second) found.push_back(std::move(resolved));
    }
  }
  return found;
}

void WorldLoading::State::fetch(std::unique_ptr<Fetch> wanted, Urgency urgency) {
  if (stopped) return;
  if (++files > kMaxFiles)
    return stop("refers to more than " + std::to_string(kMaxFiles) + " files; the rest is left out");
  wanted->priority = static_cast<int>(urgency) * kUrgencyStep;
  fetches.push_back(std::move(wanted));
  begin_next_candidate(*fetches.back());
}

void WorldLoading::State::begin_next_candidate(Fetch& fetch) {
  while (fetch.next < fetch.candidates.size()) {
    const net::Url& url = fetch.candidates[fetch.next++];
    const auto failed = [&](const std::string& why) {
      if (fetch.first_problem.empty()) fetch.first_problem = why;
    };
    if (const auto refused = net::refuse_reference(fetch.from, url)) {
      failed(*refused);
      continue;
    }
    if (url.scheme.empty() || url.scheme == "file" || url.scheme == "data") {
      local.push_back(&fetch);
      return;
    }
    if (options.offline) {
      failed(net::url_for_messages(url.text()) + ": the network is not used (--offline)");
      continue;
    }
    std::vector<net::ByteRange> ranges;
    if (fetch.max_bytes != Fetch::kNoLimit) ranges = {{0, fetch.max_bytes}};
    fetch.front = options.by_view && ranges.empty() && url.path.ends_with(".qnv");
    if (fetch.front) ranges = {{0, kFront}};
    return ask(fetch, std::move(ranges));
  }
  ended.push_back(&fetch);
  fetch.taker->missing(fetch.first_problem);
}

void WorldLoading::State::ask(Fetch& fetch, std::vector<net::ByteRange> ranges) {
  net::Request request;
  request.url = without_fragment(fetch.candidates[fetch.next - 1]);
  request.priority = fetch.priority;
  request.from = fetch.from;
  request.max_bytes = std::min(fetch.max_bytes, request.max_bytes);
  request.ranges = std::move(ranges);
  request.validator = fetch.validator;
  fetch.request = network()->request(std::move(request));
  by_request[fetch.request.value] = &fetch;
}

// Local files and data: URLs -----------------------------------------------------------------------------------------

bool WorldLoading::State::begin_local(Fetch& fetch, const net::Url& url) {
  Found found;
  found.url = url;
  found.fragment = std::exchange(found.url.fragment, {});
  found.url.has_fragment = false;
  if (url.scheme == "data") {
    auto decoded = net::decode_data_url(url.text());
    if (!decoded) {
      if (fetch.first_problem.empty()) fetch.first_problem = "malformed data: URL";
      return false;
    }
    fetch.data = std::move(decoded->bytes);
    fetch.rest = fetch.data;
    found.path = "data: URL";
  } else {
    found.local = true;
    LocalFile file = open_local_file(url, fetch.given_path);
    if (!file.file) {
      if (fetch.first_problem.empty()) fetch.first_problem = file.problem;
      return false;
    }
    fetch.file = std::move(file.file);
    fetch.rest = fetch.file->bytes();
    found.path = fetch.given_path.empty() ? file.path : fetch.given_path;
    if (fetch.given_path.empty()) found.url = net::url_of_path(file.path);
  }
  fetch.total = fetch.rest.size();
  if (fetch.rest.size() > fetch.max_bytes) {
    fetch.cut = true;
    fetch.rest = fetch.rest.first(static_cast<std::size_t>(fetch.max_bytes));
  }
  begin_taking(fetch, found);
  if (!fetch.refused && fetch.file && !fetch.cut && fetch.taker->whole_file(*fetch.file, found.path)) {
    received += fetch.rest.size();
    fetch.received = fetch.rest.size();
    fetch.rest = {};
  }
  return true;
}

void WorldLoading::State::local_step() {
  Fetch& fetch = *local.front();
  if (!fetch.begun) {
    const net::Url url = fetch.candidates[fetch.next - 1];
    if (!begin_local(fetch, url)) {
      local.pop_front();
      return begin_next_candidate(fetch);
    }
  }
  if (!fetch.refused && !fetch.rest.empty()) {
    const auto piece = fetch.rest.first(std::min(kPiece, fetch.rest.size()));
    fetch.rest = fetch.rest.subspan(piece.size());
    deliver(fetch, piece);
  }
  if (!fetch.refused && !fetch.rest.empty()) return;
  local.pop_front();
  finish(fetch, std::nullopt);
}

// The network
// ----------------------------------------------------------------------------------------------------------

net::Loader* WorldLoading::State::network() {
  if (loader) return loader.get();
  net::LoaderOptions settings;
  settings.cache_folder = options.cache_folder;
  settings.memory = options.memory;
  settings.wake = [waker = waker] { waker->wake(); };
  loader = net::Loader::create(std::move(settings));
  return loader.get();
}

void Waker::wake() {
  {
    const std::lock_guard lock(mutex_);
    awake_ = true;
  }
  something_.notify_one();
}

void Waker::wait(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  something_.wait_for(lock, time, [this] { return awake_; });
  awake_ = false;
}

bool WorldLoading::State::take_events() {
  std::vector<net::LoadEvent> polled = loader->poll();
  events.insert(events.end(), std::make_move_iterator(polled.begin()), std::make_move_iterator(polled.end()));
  const bool any = !events.empty() || loader->queued_bytes() > 0;
  while (!events.empty()) {
    net::LoadEvent event = std::move(events.front());
    events.pop_front();
    const auto known = by_request.find(event.id.value);
    if (known != by_request.end()) {
      take(*known->second, event);
      continue;
    }
    for (const auto& stream : streams)
      if (stream->take(event)) break;
    fed = true;
  }
  return any;
}

void WorldLoading::State::take(Fetch& fetch, net::LoadEvent& event) {
  const auto over = [&] {
    by_request.erase(fetch.request.value);
    fetch.request = {};
  };
  if (auto* head = std::get_if<net::LoadHead>(&event.what)) {
    fetch.total = head->total;
    fetch.cut = head->total && *head->total > fetch.max_bytes;
    if (fetch.front && !take_front(fetch, *head)) return;
    fetch.content_type = head->content_type;
    Found found;
    found.url = net::parse_url(head->url);
    found.fragment = fetch.candidates[fetch.next - 1].fragment;
    found.path = net::url_for_messages(head->url);
    if (!fetch.begun) begin_taking(fetch, found);
  } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
    if (!fetch.refused) deliver(fetch, data->bytes);
  } else if (std::holds_alternative<net::LoadDone>(event.what)) {
    over();
    if (fetch.front && fetch.total && fetch.received < *fetch.total && !fetch.refused) return take_rest(fetch);
    return finish(fetch, std::nullopt);
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    if (fetch.received > 0) {
      loader->cancel(fetch.request);
      over();
      return finish(fetch,
                    "the file changed on the server while it was read; shown is what came before, and reading "
                    "it again shows the new one");
    }
  } else if (auto* error = std::get_if<net::LoadError>(&event.what)) {
    over();
    if (fetch.begun) return finish(fetch, error->message);
    if (fetch.first_problem.empty()) fetch.first_problem = error->message;
    return begin_next_candidate(fetch);
  }
  if (!fetch.refused) return;
  loader->cancel(fetch.request);
  over();
  finish(fetch, std::nullopt);
}

// Of a long stream only the front is asked for at first. False: all of it was asked for instead.
bool WorldLoading::State::take_front(Fetch& fetch, const net::LoadHead& head) {
  fetch.validator = head.validator;
  if (head.accepts_ranges && head.total && *head.total >= kWorthChoosing) return true;
  fetch.front = false;
  if (head.total && *head.total <= kFront) return true;
  loader->cancel(fetch.request);
  by_request.erase(fetch.request.value);
  ask(fetch, {});
  return false;
}

void WorldLoading::State::take_rest(Fetch& fetch) {
  fetch.front = false;
  RangedStream::Place place;
  place.url = without_fragment(fetch.candidates[fetch.next - 1]);
  place.from = fetch.from;
  place.validator = fetch.validator;
  place.front = fetch.received;
  place.total = *fetch.total;
  if (fetch.taker->seek(std::move(place)))
    ended.push_back(&fetch);
  else
    ask(fetch, {{fetch.received, *fetch.total}});
}

ReadFile WorldLoading::State::reader_beside(const net::Url& base) {
  return [this, base](const std::string& name) -> std::optional<std::vector<std::byte>> {
    const net::Url url = net::resolve(base, net::parse_url(net::tidy_url(name)));
    if (net::refuse_reference(base.text(), url)) return std::nullopt;
    if (url.scheme == "file") {
      const LocalFile local_file = open_local_file(url);
      if (!local_file.file) return std::nullopt;
      const auto bytes = local_file.file->bytes();
      return std::vector<std::byte>(bytes.begin(), bytes.end());
    }
    if (url.scheme == "data") {
      auto decoded = net::decode_data_url(url.text());
      return decoded ? std::optional(std::move(decoded->bytes)) : std::nullopt;
    }
    return options.offline ? std::nullopt : read_now(without_fragment(url), base.text());
  };
}

// An importer cannot go on without. What comes meanwhile for others waits.
std::optional<std::vector<std::byte>> WorldLoading::State::read_now(const std::string& url, const std::string& from) {
  net::Request wanted;
  wanted.url = url;
  wanted.from = from;
  wanted.priority = static_cast<int>(Urgency::world) * kUrgencyStep;
  const net::RequestId id = network()->request(std::move(wanted));
  std::vector<std::byte> bytes;
  bool over = false, whole = false;
  while (!over && !limit.over()) {
    for (net::LoadEvent& event : loader->poll()) {
      if (event.id != id) {
        events.push_back(std::move(event));
      } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
        bytes.insert(bytes.end(), data->bytes.begin(), data->bytes.end());
      } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
        bytes.clear();
      } else {
        whole = whole || std::holds_alternative<net::LoadDone>(event.what);
        over = whole || std::holds_alternative<net::LoadError>(event.what);
      }
    }
    if (!over && loader->queued_bytes() == 0) waker->wait(kLongestWait);
  }
  loader->cancel(id);
  received += bytes.size();
  return whole ? std::optional(std::move(bytes)) : std::nullopt;
}

// What has come
// ----------------------------------------------------------------------------------------------------------

void WorldLoading::State::begin_taking(Fetch& fetch, const Found& found) {
  fetch.begun = true;
  fetch.refused = !fetch.taker->begin(found);
}

void WorldLoading::State::deliver(Fetch& fetch, std::span<const std::byte> bytes) {
  if (fetch.max_bytes != Fetch::kNoLimit && bytes.size() > fetch.max_bytes - fetch.received)
    bytes = bytes.first(static_cast<std::size_t>(fetch.max_bytes - fetch.received));
  fetch.received += bytes.size();
  received += bytes.size();
  fetch.taker->cut = fetch.cut;
  if (!bytes.empty()) fetch.taker->more(bytes);
}

void WorldLoading::State::finish(Fetch& fetch, const std::optional<std::string>& problem) {
  ended.push_back(&fetch);
  fetch.taker->cut = fetch.cut;
  if (!fetch.refused) fetch.taker->end(problem);
}

void WorldLoading::State::stop(const std::string& why) {
  if (std::exchange(stopped, true)) return;
  const bool cancelled = limit.cancelled && *limit.cancelled;
  if (!cancelled) report(Severity::error, root && root->scene ? root->scene->file_name() : world.path, {}, why);
  for (const auto& [id, fetch] : by_request) loader->cancel(fetch->request);
  by_request.clear();
  local.clear();
  // What has come of each is kept. What is begun meanwhile is refused, since this has stopped.
  for (std::size_t i = 0; i < fetches.size(); ++i) {
    Fetch& fetch = *fetches[i];
    if (std::find(ended.begin(), ended.end(), &fetch) != ended.end()) continue;
    fetch.taker->cut = true;
    if (fetch.begun && !fetch.refused) fetch.taker->end(std::nullopt);
    if (fetch.taker == root) root->whole = false;
  }
  ended.clear();
  fetches.clear();
  is_done = true;
}

bool WorldLoading::State::step(std::chrono::milliseconds wait) {
  bool busy = false;
  // First, so that however short the time is, something shows.
  if (!local.empty()) {
    local_step();
    busy = true;
  }
  if (!is_done && !fetches.empty() && ended.size() < fetches.size() && limit.over())
    stop("the time for loading is over; what is missing is left out");
  if (is_done && streams.empty()) return false;
  if (loader) busy = take_events() || busy;
  for (const auto& stream : streams) busy = stream->ask_for_more() || busy;
  std::erase_if(streams, [](const auto& stream) { return stream->over(); });
  for (Fetch* fetch : std::exchange(ended, {}))
    std::erase_if(fetches, [fetch](const auto& one) { return one.get() == fetch; });
  if (!is_done && fetches.empty()) is_done = true;
  if (!busy && !is_done) set_priorities();
  if (busy || (is_done && !taken)) return !is_done || !streams.empty();
  waker->wait(std::min(wait, kLongestWait));
  return true;
}

void WorldLoading::State::set_priorities() {
  if (!loader || by_request.empty() || !root || !root->scene) return;
  const auto now = Clock::now();
  if (now < next_priorities) return;
  next_priorities = now + std::chrono::milliseconds(200);
  std::unordered_set<const vrml::Node*> wanted;
  for (const auto& [id, fetch] : by_request)
    if (fetch->node) wanted.insert(fetch->node);
  const auto importance = importance_of(*root->scene, wanted, viewer);
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

// WorldLoading --------------------------------------------------------------------------------------------------------

WorldLoading::WorldLoading(const std::string& asked, const LoadOptions& options)
    : state_(std::make_unique<State>(asked, options)) {
  state_->start();
}
WorldLoading::~WorldLoading() = default;

bool WorldLoading::step(std::chrono::milliseconds wait) { return state_->step(wait); }
bool WorldLoading::done() const { return state_->is_done; }
void WorldLoading::wake() { state_->waker->wake(); }
bool WorldLoading::changed() const { return state_->changed; }
bool WorldLoading::streaming() const { return !state_->streams.empty(); }
bool WorldLoading::fed() { return std::exchange(state_->fed, false); }
void WorldLoading::look_from(const glm::vec3& viewer) { state_->viewer = viewer; }

render::RenderList WorldLoading::collect(const glm::vec3& viewer) {
  State& s = *state_;
  s.changed = false;
  if (!s.root->scene || s.root->refused) return {};
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

const vrml::Diagnostics& WorldLoading::diagnostics() const { return state_->world.diagnostics; }
const std::vector<std::shared_ptr<StreamFeed>>& WorldLoading::feeds() const { return state_->world.feeds; }
const std::string& WorldLoading::title() const { return state_->world.title; }

OpenedWorld WorldLoading::take(render::MeshCache* meshes) {
  State& s = *state_;
  s.taken = true;
  OpenedWorld world = std::move(s.world);
  world.bytes = s.root->bytes();
  world.parse_seconds = s.root->seconds();
  world.truncated = !s.root->whole;
  world.scene = s.root->release();
  if (world.scene)
    if (std::string title = title_of(*world.scene); !title.empty()) world.title = std::move(title);
  if (meshes) {
    s.root->forget_open(s.meshes);
    *meshes = std::move(s.meshes);
  }
  s.meshes = {};
  return world;
}

}  // namespace gs::app
