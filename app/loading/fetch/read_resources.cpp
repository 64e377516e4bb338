#include "app/loading/fetch/read_resources.h"

#include "app/loading/fetch/fetch.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {

std::string without_fragment(net::Url url) {
  url.fragment.clear();
  url.has_fragment = false;
  return url.text();
}

namespace {

/// Request with the bytes that were received.
struct CollectedRequest {
  net::RequestId id;
  std::vector<std::byte> bytes;
  std::optional<std::uint64_t> total;
  std::optional<FileResult> result;  // once it is over
  bool only_total = false;           // the request asks for the length of the resource
};

/// Status codes that mean that a resource does not exist. Stores such as S3 answer 403 if they may not be listed.
bool is_absent_resource(const net::LoadError& error) {
  return error.kind == net::LoadErrorKind::not_found || error.http_status == 403;
}

}  // namespace

std::vector<FileResult> read_resources(net::Loader& loader, std::span<const WantedPart> wanted, const net::Origin& from,
                                       const WorldBudget& budget, const ReadingHooks& hooks) {
  std::vector<CollectedRequest> requests(wanted.size());
  struct Held {
    explicit Held(const WorldBudget& budget) : share(budget, Resource::files) {}
    std::vector<std::vector<std::byte>> bytes;
    Share share;
  };
  const auto held = std::make_shared<Held>(budget);
  const auto ask_for = [&](CollectedRequest& request, const WantedPart& one, std::vector<net::ByteRange> ranges) {
    net::Request made;
    made.url = without_fragment(one.url);
    made.from = from;
    made.cache = one.cache;
    made.ranges = std::move(ranges);
    made.priority = static_cast<int>(Urgency::world) * kUrgencyStep;
    request.id = loader.request(std::move(made));
  };
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    std::vector<net::ByteRange> ranges;
    if (const auto& part = wanted[i].part) {
      requests[i].only_total = part->from_end;
      ranges = {part->from_end ? net::ByteRange{0, 1} : net::ByteRange{part->offset, part->offset + part->bytes}};
    }
    ask_for(requests[i], wanted[i], std::move(ranges));
  }
  std::size_t open = requests.size();
  const auto finish = [&](CollectedRequest& request, FileResult result) {
    request.result = std::move(result);
    --open;
  };
  const auto end = [&](CollectedRequest& request, const WantedPart& one) {
    if (!request.only_total) return finish(request, SharedBytes{held, request.bytes});
    const std::uint64_t length = one.part->bytes;
    if (!request.total || *request.total < length)
      return finish(request, net::url_for_messages(one.url.text()) + ": expected at least " + std::to_string(length) +
                                 " bytes, and a server that states the length");
    request.only_total = false;
    request.bytes.clear();
    ask_for(request, one, {{*request.total - length, *request.total}});
  };
  while (open > 0 && !hooks.stopped()) {
    for (net::LoadEvent& event : loader.poll()) {
      const auto request = std::ranges::find(requests, event.id, &CollectedRequest::id);
      if (request == requests.end()) {
        if (hooks.other) hooks.other(std::move(event));
        continue;
      }
      if (request->result) continue;
      const WantedPart& one = wanted[static_cast<std::size_t>(request - requests.begin())];
      if (const auto* const head = std::get_if<net::LoadHead>(&event.what)) {
        request->total = head->total;
      } else if (const auto* const data = std::get_if<net::LoadData>(&event.what)) {
        if (!held->share.grow(data->bytes.size())) {
          finish(*request, budget->refusal(Resource::files));
          continue;
        }
        request->bytes.insert(request->bytes.end(), data->bytes.begin(), data->bytes.end());
      } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
        request->bytes.clear();
      } else if (std::holds_alternative<net::LoadDone>(event.what)) {
        end(*request, one);
      } else if (auto* const error = std::get_if<net::LoadError>(&event.what)) {
        finish(*request, is_absent_resource(*error) ? FileResult(NoFile{std::move(error->message)}) : FileResult(std::move(error->message)));
      }
    }
    if (open > 0 && loader.queued_bytes() == 0) hooks.wait();
  }
  std::vector<FileResult> results;
  for (CollectedRequest& request : requests) {
    loader.cancel(request.id);
    if (hooks.received) hooks.received(request.bytes.size());
    if (!request.result) request.result = std::string("the time limit for loading was reached");
    if (auto* const bytes = std::get_if<SharedBytes>(&*request.result)) {
      // The bytes keep their place when the vector moves.
      held->bytes.push_back(std::move(request.bytes));
      *bytes = {held, held->bytes.back()};
    }
    results.push_back(std::move(*request.result));
  }
  return results;
}

ServedFiles::ServedFiles(net::LoaderOptions settings, WorldBudget budget)
    : budget_(std::move(budget)), settings_(std::move(settings)) {
  settings_.wake = [waker = waker_] { waker->wake(); };
}

ServedFiles::~ServedFiles() = default;

std::vector<FileResult> ServedFiles::read(std::span<const WantedPart> wanted, const net::Origin& from) {
  constexpr std::chrono::milliseconds kWait{50};
  const std::lock_guard lock(mutex_);
  if (!loader_) loader_ = net::Loader::create(net::LoaderOptions(settings_));
  ReadingHooks hooks;
  hooks.stopped = [this] { return budget_->stopped(); };
  hooks.wait = [&] { waker_->wait(kWait); };
  return read_resources(*loader_, wanted, from, budget_, hooks);
}

}  // namespace gs::app
