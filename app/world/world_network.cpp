#include "app/base/local_file.h"
#include "app/world/world_loading_state.h"
#include "net/base/schemes.h"
#include "net/load/transport.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

// Events of the loader for network resources.
namespace gs::app {
namespace {

constexpr std::uint64_t kWorthChoosing = std::uint64_t{1} << 20;  // shorter streams are read as a whole

std::string without_fragment(net::Url url) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text();
}

// Converts bits to bytes per second. Rounds up, because 0 means unlimited.
std::uint64_t byte_rate_of(std::uint64_t bits) { return bits / 8 + (bits % 8 > 0 ? 1 : 0); }

}  // namespace

net::Loader* WorldLoading::State::network() {
  if (loader) return loader.get();
  net::LoaderOptions settings;
  settings.cache_folder = options.cache_folder;
  settings.memory = options.memory;
  settings.policy = policy;
  settings.bytes_per_second = byte_rate_of(options.rate);
  settings.wake = [waker = waker] { waker->wake(); };
  loader = net::Loader::create(std::move(settings));
  return loader.get();
}

// Applies a bandwidth limit that the interface has changed.
void WorldLoading::State::follow_rate() {
  const std::optional<std::uint64_t> asked = ledger->rate();
  if (!asked || *asked == options.rate) return;
  options.rate = *asked;
  if (loader) loader->set_rate(byte_rate_of(options.rate));
  set_cell_rate();
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
    streams_grew = true;
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
    if (fetch.part == Fetch::Part::front && !take_front(fetch, *head)) return;
    fetch.content_type = head->content_type;
    Found found;
    found.url = net::parse_url(head->url);
    found.fragment = fetch.candidates[fetch.next - 1].fragment;
    found.path = net::url_for_messages(head->url);
    found.origin = head->origin();
    if (fetch.stage == Fetch::Stage::seeking) begin_taking(fetch, found);
  } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
    if (fetch.stage == Fetch::Stage::receiving) deliver(fetch, data->bytes);
  } else if (std::holds_alternative<net::LoadDone>(event.what)) {
    over();
    if (fetch.part == Fetch::Part::front && fetch.stage == Fetch::Stage::receiving && fetch.total &&
        fetch.received < *fetch.total)
      return take_rest(fetch);
    return finish(fetch, std::nullopt);
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    if (fetch.received > 0) {
      loader->cancel(fetch.request);
      over();
      return finish(fetch,
                    "the file changed on the server during the transfer; the earlier version is shown; reload to get "
                    "the new one");
    }
  } else if (auto* error = std::get_if<net::LoadError>(&event.what)) {
    over();
    if (fetch.stage != Fetch::Stage::seeking) return finish(fetch, error->message);
    fail_candidate(fetch, error->message);
    return begin_next_candidate(fetch);
  }
  if (fetch.stage != Fetch::Stage::refused) return;
  loader->cancel(fetch.request);
  over();
  finish(fetch, std::nullopt);
}

// Limits the request for a long stream to its front. Returns false if it has requested the whole resource instead.
bool WorldLoading::State::take_front(Fetch& fetch, const net::LoadHead& head) {
  fetch.validator = head.validator;
  if (head.accepts_ranges && head.total && *head.total >= kWorthChoosing) return true;
  fetch.part = Fetch::Part::all;
  if (head.total && *head.total <= kFrontBytes) return true;
  loader->cancel(fetch.request);
  by_request.erase(fetch.request.value);
  ask(fetch, {});
  return false;
}

void WorldLoading::State::take_rest(Fetch& fetch) {
  fetch.part = Fetch::Part::all;
  RangedStream::Place place;
  place.url = without_fragment(fetch.candidates[fetch.next - 1]);
  place.from = fetch.from;
  place.validator = fetch.validator;
  place.front = fetch.received;
  place.total = *fetch.total;
  place.ledger = ledger;
  place.row = fetch.row;
  if (fetch.handler->seek(std::move(place))) {
    ended.push_back(&fetch);
    fetch.handler->tell_progress(1);  // views request the rest
  } else
    ask(fetch, {{fetch.received, *fetch.total}});
}

ReadFile WorldLoading::State::reader_of(const net::Origin& origin) {
  return [this, origin](const std::string& name) -> BytesResult {
    const net::Url url = net::resolve(net::parse_url(origin.url), net::parse_url(net::tidy_url(name)));
    const auto refused = policy.refuse(origin, url);
    if (refused && !refused->folder.empty()) (void)refuse_folder(refused->folder, name);
    if (refused) return name + ": " + refused->message;
    if (url.scheme == "file") {
      LocalFile local_file = open_local_file(url, policy, origin);
      if (!local_file.folder.empty()) (void)refuse_folder(local_file.folder, name);
      if (!local_file.file) return local_file.problem;
      return shared_bytes(std::move(*local_file.file));
    }
    if (url.scheme == "data") {
      auto decoded = net::decode_data_url(url.text());
      if (!decoded) return std::string("malformed data: URL");
      return shared_bytes(std::move(decoded->bytes));
    }
    if (options.offline) return name + ": the network is disabled (--offline)";
    return read_now(without_fragment(url), origin);
  };
}

// Reads a resource that an importer needs to continue. Events of other requests are queued meanwhile.
BytesResult WorldLoading::State::read_now(const std::string& url, const net::Origin& from) {
  net::Request wanted;
  wanted.url = url;
  wanted.from = from;
  wanted.priority = static_cast<int>(Urgency::world) * kUrgencyStep;
  const net::RequestId id = network()->request(std::move(wanted));
  std::vector<std::byte> bytes;
  Share share(budget, Resource::files);
  std::optional<std::string> problem = "the time limit for loading was reached";
  bool over = false;
  while (!over && !limit.over()) {
    for (net::LoadEvent& event : loader->poll()) {
      if (event.id != id) {
        events.push_back(std::move(event));
      } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
        if (over) continue;
        if (!share.grow(data->bytes.size())) {
          over = true;
          problem = budget->refusal(Resource::files);
          continue;
        }
        bytes.insert(bytes.end(), data->bytes.begin(), data->bytes.end());
      } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
        bytes.clear();
      } else if (std::holds_alternative<net::LoadDone>(event.what)) {
        over = true;
        problem.reset();
      } else if (auto* error = std::get_if<net::LoadError>(&event.what)) {
        over = true;
        problem = std::move(error->message);
      }
    }
    if (!over && loader->queued_bytes() == 0) waker->wait(kLongestWait);
  }
  loader->cancel(id);
  received += bytes.size();
  if (problem) return std::move(*problem);
  struct Held {
    std::vector<std::byte> bytes;
    Share share;
  };
  const auto held = std::make_shared<const Held>(Held{std::move(bytes), std::move(share)});
  return SharedBytes{held, held->bytes};
}

}  // namespace gs::app
