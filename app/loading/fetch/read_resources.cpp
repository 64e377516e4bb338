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

/// Reports whether an error means that a resource never existed. Stores such as S3 answer 403 if clients may not list
/// them. Status 410 means that the resource existed, so it must not count as a missing part.
bool is_absent_resource(const net::LoadError& error) {
  constexpr int kForbidden = 403, kGone = 410;
  return (error.kind == net::LoadErrorKind::not_found && error.http_status != kGone) || error.http_status == kForbidden;
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
    made.max_bytes = one.max_bytes;
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
        if (hooks.head) hooks.head(static_cast<std::size_t>(request - requests.begin()), *head);
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
        finish(*request, is_absent_resource(*error) ? FileResult(NoFile{std::move(error->message)})
                                                    : FileResult(std::move(error->message)));
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

std::optional<RangesProblem> read_ranges(net::Loader& loader, const WantedRanges& wanted, const net::Origin& from,
                                         const TakeBytes& take, const ReadingHooks& hooks) {
  net::Request made;
  made.url = without_fragment(wanted.url);
  made.from = from;
  made.cache = wanted.cache;
  made.ranges = wanted.ranges;
  made.validator = wanted.validator;
  made.priority = static_cast<int>(Urgency::world) * kUrgencyStep;
  const net::RequestId id = loader.request(std::move(made));
  const RangesProblem changed{
      net::url_for_messages(wanted.url.text()) + ": the file changed on the server; reload to get the new version",
      true};
  std::optional<RangesProblem> problem;
  bool open = true;
  const auto end = [&](std::optional<RangesProblem> why) {
    problem = std::move(why);
    open = false;
  };
  while (open && !hooks.stopped()) {
    for (net::LoadEvent& event : loader.poll()) {
      if (event.id != id) {
        if (hooks.other) hooks.other(std::move(event));
        continue;
      }
      if (!open) continue;
      if (const auto* const head = std::get_if<net::LoadHead>(&event.what)) {
        if ((head->total && *head->total != wanted.total) ||
            (!wanted.validator.empty() && !wanted.validator.agrees(head->validator)))
          end(changed);
      } else if (const auto* const data = std::get_if<net::LoadData>(&event.what)) {
        if (hooks.received) hooks.received(data->bytes.size());
        if (!take(data->offset, data->bytes)) end(RangesProblem{"the received bytes cannot be kept"});
      } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
        end(changed);
      } else if (std::holds_alternative<net::LoadDone>(event.what)) {
        end(std::nullopt);
      } else if (const auto* const error = std::get_if<net::LoadError>(&event.what)) {
        end(error->kind == net::LoadErrorKind::changed ? changed : RangesProblem{error->message});
      }
    }
    if (open && loader.queued_bytes() == 0) hooks.wait();
  }
  loader.cancel(id);
  if (open) problem = RangesProblem{"the time limit for loading was reached"};
  return problem;
}

ServedFiles::ServedFiles(net::LoaderOptions settings, WorldBudget budget)
    : budget_(std::move(budget)), settings_(std::move(settings)) {
  settings_.wake = [waker = waker_] { waker->wake(); };
}

ServedFiles::~ServedFiles() = default;

ReadingHooks ServedFiles::prepare() {
  static constexpr std::chrono::milliseconds kWait{50};
  if (!loader_) loader_ = net::Loader::create(net::LoaderOptions(settings_));
  ReadingHooks hooks;
  hooks.stopped = [this] { return budget_->stopped(); };
  hooks.wait = [this] { waker_->wait(kWait); };
  return hooks;
}

std::vector<FileResult> ServedFiles::read(std::span<const WantedPart> wanted, const net::Origin& from) {
  const std::lock_guard lock(mutex_);
  const ReadingHooks hooks = prepare();
  if (ahead_.empty()) return read_resources(*loader_, wanted, from, budget_, hooks);
  std::vector<std::optional<FileResult>> known(wanted.size());
  std::vector<WantedPart> rest;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto found = wanted[i].part ? ahead_.end() : ahead_.find(without_fragment(wanted[i].url));
    if (found == ahead_.end()) {
      rest.push_back(wanted[i]);
      continue;
    }
    known[i] = std::move(found->second.result);
    ahead_.erase(found);
  }
  std::vector<FileResult> read;
  if (!rest.empty()) read = read_resources(*loader_, rest, from, budget_, hooks);
  std::vector<FileResult> results;
  auto next = read.begin();
  for (std::optional<FileResult>& one : known) results.push_back(one ? std::move(*one) : std::move(*next++));
  return results;
}

void ServedFiles::read_ahead(std::span<const net::Url> urls, const net::Origin& from) {
  const std::lock_guard lock(mutex_);
  ReadingHooks hooks = prepare();
  std::vector<std::optional<net::LoadHead>> heads(urls.size());
  hooks.head = [&heads](std::size_t index, const net::LoadHead& head) { heads[index] = head; };
  std::vector<WantedPart> wanted;
  for (const net::Url& url : urls) wanted.push_back({url, std::nullopt});
  std::vector<FileResult> results = read_resources(*loader_, wanted, from, budget_, hooks);
  for (std::size_t i = 0; i < urls.size(); ++i)
    ahead_.insert_or_assign(without_fragment(urls[i]), Ahead{std::move(results[i]), std::move(heads[i])});
}

const ServedFiles::Ahead* ServedFiles::find_ahead(const net::Url& url) const {
  const auto found = ahead_.find(without_fragment(url));
  return found == ahead_.end() ? nullptr : &found->second;
}

std::optional<RangesProblem> ServedFiles::read_ranges(const WantedRanges& wanted, const net::Origin& from,
                                                      const TakeBytes& take) {
  const std::lock_guard lock(mutex_);
  const ReadingHooks hooks = prepare();
  return app::read_ranges(*loader_, wanted, from, take, hooks);
}

}  // namespace gs::app
