#include "net/load/load_job.h"

#include <algorithm>

namespace gs::net {
namespace {

/// Maximum bytes of an unneeded body that are read to keep the connection open.
constexpr std::uint64_t kWorthReading = std::uint64_t{16} << 10;

std::string status_text(int status) {
  constexpr std::pair<int, const char*> kPhrases[] = {{400, "Bad Request"},
                                                      {401, "Unauthorized"},
                                                      {403, "Forbidden"},
                                                      {404, "Not Found"},
                                                      {407, "Proxy Authentication Required"},
                                                      {408, "Request Timeout"},
                                                      {410, "Gone"},
                                                      {429, "Too Many Requests"},
                                                      {500, "Internal Server Error"},
                                                      {502, "Bad Gateway"},
                                                      {503, "Service Unavailable"},
                                                      {504, "Gateway Timeout"}};
  std::string result = std::to_string(status);
  for (const auto& [number, phrase] : kPhrases)
    if (number == status) result.append(" ").append(phrase);
  return result;
}

bool is_redirect(int status) {
  return status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
}

bool is_transient(int status) {
  return status == 408 || status == 429 || status == 500 || status == 502 || status == 503 || status == 504;
}

std::string range_text(std::uint64_t begin, std::uint64_t end) {
  return std::to_string(begin) + " to " + (end == kOpenEnd ? "the end" : std::to_string(end - 1));
}

// Returns the error if a response does not fit the request; nullopt if it fits.
std::optional<LoadError> check_answer(const Request& request, const Fetch& fetch, const ResponseHead& head) {
  const auto bad = [](const std::string& what) { return LoadError{LoadErrorKind::bad_response, what, 0}; };
  if (!request.validator.empty() && !request.validator.agrees(head.validator))
    return LoadError{LoadErrorKind::changed, "it is no longer the requested version", 0};
  if (head.status != 206) return std::nullopt;
  const std::string expected = "; expected bytes " + range_text(fetch.position, fetch.range.end);
  if (fetch.position == 0 && fetch.range.end == kOpenEnd)
    return bad("the server answered 206 Partial Content; expected the whole file");
  if (head.content_type.starts_with("multipart/byteranges")) return bad("the server sent several ranges" + expected);
  if (head.encoded) return bad("the server sent part of a compressed body" + expected);
  if (!head.content_range || !head.content_range->begin)
    return bad("the server answered 206 Partial Content without Content-Range" + expected);
  if (*head.content_range->begin != fetch.position || *head.content_range->end > fetch.range.end)
    return bad("the server sent bytes " + range_text(*head.content_range->begin, *head.content_range->end) + expected);
  if (head.content_length && *head.content_length != *head.content_range->end - fetch.position)
    return bad("the server announced " + std::to_string(*head.content_length) + " bytes for a part of " +
               std::to_string(*head.content_range->end - fetch.position));
  return std::nullopt;
}

}  // namespace

HeadVerdict LoadJob::on_head(Fetch& fetch, const ResponseHead& head) {
  fetch.answer = {};
  if (const auto why = refuse_host(location_.reach(), head.space)) {
    fail(LoadErrorKind::forbidden, *why);
    return HeadVerdict::stop;
  }
  fetch.answer.space = head.space;
  note_server(true);
  if (is_redirect(head.status) && !head.location.empty()) {
    fetch.answer.redirect = head.location;
    return HeadVerdict::discard;
  }
  if (head.status == 304 && fetch.conditional && cache_.has_entry()) {
    fetch.answer.not_modified = head;
    return HeadVerdict::discard;
  }
  if (head.status == 200 || head.status == 203 || head.status == 206) return accept(fetch, head);
  if (head.status == 416) return accept_empty(fetch, head);
  LoadErrorKind kind = LoadErrorKind::http_status;
  if (head.status == 404 || head.status == 410) kind = LoadErrorKind::not_found;
  if (head.status < 400) kind = LoadErrorKind::bad_response;
  fetch.answer.error =
      LoadError{kind, "the server answered " + status_text(head.status) + "; expected 200 OK", head.status};
  fetch.answer.transient = is_transient(head.status);
  fetch.answer.retry_after = head.retry_after;
  return HeadVerdict::discard;
}

/// Handles status 416: the range begins after the end of the resource.
HeadVerdict LoadJob::accept_empty(Fetch& fetch, const ResponseHead& head) {
  const auto total = head.content_range ? head.content_range->total : std::nullopt;
  if (cache_.has_entry() && !head_sent_) {
    restart(LoadErrorKind::changed, "it became shorter", {});
  } else if (total && (head_sent_ ? !version_.total : fetch.position == 0 && *total == 0)) {
    fetch.finished = true;
    plan_.stop(fetch);
    if (head_sent_) {
      if (set_total(*total)) check_done();
    } else {
      adopt(head, total);
      check_done();
    }
  } else {
    fail(LoadErrorKind::bad_request,
         "byte " + std::to_string(fetch.position) + " was requested; it has " +
             (total ? std::to_string(*total) : "fewer") + " bytes",
         head.status);
  }
  return HeadVerdict::stop;
}

HeadVerdict LoadJob::accept(Fetch& fetch, const ResponseHead& head) {
  if (const auto error = check_answer(request_, fetch, head)) {
    fail(error->kind, error->message);
    return HeadVerdict::stop;
  }
  const bool whole_body = head.status != 206;
  const auto total = whole_body ? head.content_length : head.content_range->total;
  const Validator& validator = version_.validator;
  const bool agrees = validator.agrees(head.validator) && (!version_.total || !total || *version_.total == *total);
  const bool proven = agrees && !version_.encoded && !head.encoded && !validator.strong().empty() &&
                      validator.strong() == head.validator.strong();
  if (cache_.has_entry() && !cache_.trusted()) {
    if (!proven && !whole_body) {
      restart(LoadErrorKind::changed, "it changed since it was cached", {});
      return HeadVerdict::stop;
    }
    // Keep the cached bytes only if the server's version equals the cached version.
    if (proven) {
      cache_.confirm(validator, freshness(head));
    } else {
      cache_.forget_entry();
      version_ = {};
    }
  } else if (head_sent_ && (!agrees || (whole_body && delivery_.received() > 0 && !proven))) {
    restart(
        LoadErrorKind::changed,
        agrees ? "the server cannot resume an interrupted transfer" : "it changed on the server during the transfer",
        {});
    return HeadVerdict::stop;
  }
  if (!head_sent_) adopt(head, total);
  if (over_) return HeadVerdict::stop;
  location_.narrow_reach(head.space);
  if (!version_.total && total && !set_total(*total)) return HeadVerdict::stop;
  fetch.answer.whole = whole_body;
  if (whole_body) {
    // This body contains all requested bytes in order, so stop the other transfers.
    plan_.finish_others(&fetch);
    const RangeSet& needed = delivery_.needed();
    fetch.position = 0;
    fetch.range = {0, delivery_.whole() ? kOpenEnd : needed.empty() ? 0 : needed.ranges().back().end};
    fetch.answer.end = head.content_length;
  } else {
    fetch.answer.end = head.content_range->end;
    plan_.cover(delivery_.needed().without(cache_.held(delivery_.needed())));
  }
  cache_.open_writer(head, version_);
  return HeadVerdict::take;
}

/// Makes the version of this response the current version.
void LoadJob::adopt(const ResponseHead& head, std::optional<std::uint64_t> total) {
  if (!cache_.has_entry()) {
    version_.validator = head.validator;
    version_.encoded = head.encoded;
    version_.space = head.space;
  }
  version_.space = std::max(version_.space, head.space);
  if (total) version_.total = total;
  version_.accepts_ranges = head.accepts_ranges && !head.encoded;
  if (version_.accepts_ranges) {
    constexpr std::size_t kMax = 1024;
    if (context_.ranges_known.size() >= kMax) context_.ranges_known.clear();
    context_.ranges_known[location_.url()] = true;
  }
  emit_head(head.content_type);
}

DataVerdict LoadJob::on_data(Fetch& fetch, std::span<const std::byte> bytes) {
  const std::uint64_t begin = fetch.position + fetch.answer.held.size();
  const std::uint64_t end = begin + bytes.size();
  if (end < begin || (fetch.answer.end && end > *fetch.answer.end)) {
    fail(LoadErrorKind::bad_response,
         "the server sent more than the " + std::to_string(fetch.answer.end.value_or(0)) + " bytes it announced");
    return DataVerdict::stop;
  }
  if (!delivery_.is_next(fetch.position)) {
    fetch.answer.held.insert(fetch.answer.held.end(), bytes.begin(), bytes.end());
    return DataVerdict::pause;
  }
  return deliver(fetch, bytes);
}

DataVerdict LoadJob::deliver(Fetch& fetch, std::span<const std::byte> bytes) {
  const std::uint64_t begin = fetch.position, end = begin + bytes.size();
  if (delivery_.exceeds_limit({begin, end})) {
    fail(LoadErrorKind::too_large, "more than " + std::to_string(request_.max_bytes) + " bytes were received" +
                                       (version_.encoded ? " after decompression" : "") +
                                       ", the limit of this request");
    return DataVerdict::stop;
  }
  cache_.append(begin, bytes);
  if (delivery_.push(begin, bytes)) fetch.failures = 0;
  fetch.position = end;
  const bool more_wanted = !delivery_.needed().within(ByteRange{end, fetch.range.end}).empty();
  const bool nearly_over = fetch.answer.end && *fetch.answer.end - end <= kWorthReading;
  if (!more_wanted && !nearly_over) {
    fetch.finished = true;
    plan_.stop(fetch);
    check_done();
    return DataVerdict::stop;
  }
  return delivery_.room() == 0 ? DataVerdict::pause : DataVerdict::more;
}

void LoadJob::on_end(Fetch& fetch, const TransferEnd& end, TimePoint now) {
  fetch.transfer = 0;
  if (!fetch.answer.held.empty()) {
    fetch.answer.held_end = end;
    return;
  }
  const Fetch::Answer& answer = fetch.answer;
  if (!answer.redirect.empty()) return follow(std::string(answer.redirect), answer.space);
  if (answer.not_modified) {
    // Status 304: the cached version is still valid.
    const ResponseHead head = *answer.not_modified;
    fetch.answer = {};
    fetch.finished = true;
    const bool says = head.cache_control.max_age || head.expires || head.cache_control.no_cache;
    cache_.confirm(version_.validator, says ? freshness(head) : cache_.head().fresh_for);
    version_.space = std::max(version_.space, head.space);
    emit_head(cache_.head().content_type);
    return check_done();
  }
  if (answer.error) return retry(fetch, LoadError(*answer.error), answer.transient, answer.retry_after, now);
  if (!end.error) return end_body(fetch, now);
  if (end.error->kind != LoadErrorKind::changed) return retry(fetch, *end.error, end.transient, std::nullopt, now);
  restart(end.error->kind, end.error->message, now + context_.options.retry_delay);
}

void LoadJob::end_body(Fetch& fetch, TimePoint now) {
  const auto broken = [&](std::uint64_t expected) {
    retry(
        fetch,
        {LoadErrorKind::broken,
         "the connection ended after byte " + std::to_string(fetch.position) + "; expected " + std::to_string(expected),
         0},
        true, std::nullopt, now);
  };
  if (!head_sent_) return broken(0);
  if (fetch.answer.end && fetch.position < *fetch.answer.end) return broken(*fetch.answer.end);
  if (fetch.answer.whole) {
    const auto total = version_.total;
    if (total && !delivery_.needed().empty() && fetch.position < *total) return broken(*total);
    if (!total && !set_total(fetch.position)) return;
  }
  const RangeSet rest = delivery_.needed().within(ByteRange{fetch.position, fetch.range.end});
  fetch.answer = {};
  fetch.finished = rest.empty();
  if (!fetch.finished) {
    // A server may send fewer bytes than requested. Retry with the rest.
    if (++fetch.failures > context_.options.max_retries || fetch.attempts >= context_.options.max_attempts)
      return fail(LoadErrorKind::bad_response, "the server sent bytes up to " + std::to_string(fetch.position) +
                                                   " only; expected " + range_text(fetch.range.begin, fetch.range.end));
    fetch.position = rest.ranges().front().begin;
    return;
  }
  check_done();
}

void LoadJob::follow(const std::string& location, AddressSpace space) {
  // Another server must not get the authorization, nor the change that a POST makes.
  if (request_.post || !request_.authorization.empty())
    return fail(LoadErrorKind::bad_response, "the server redirects the request; expected an answer");
  const auto target = location_.redirect_target(location, space);
  if (const auto* const error = std::get_if<LoadError>(&target)) return fail(error->kind, error->message);
  const bool sent = head_sent_;
  if (sent && !void_version(LoadErrorKind::changed, "the server started to redirect during the transfer")) return;
  plan_.stop_all();
  location_.redirect_to(std::get<Url>(target));
  if (const auto why = location_.invalid()) return fail(LoadErrorKind::bad_response, *why);
  cache_.set_searching(!sent);
  open_version();
}

void LoadJob::note_server(bool answered) {
  constexpr std::size_t kMaxServers = 1024;
  if (context_.servers.size() >= kMaxServers) context_.servers.clear();
  context_.servers[location_.host()] |= answered;
}

void LoadJob::retry(Fetch& fetch, const LoadError& error, bool transient, std::optional<std::int64_t> retry_after,
                    TimePoint now) {
  const LoaderOptions& options = context_.options;
  fetch.answer = {};
  ++fetch.failures;
  // If a known server cannot be reached, or breaks connections, it may be restarting.
  if (error.kind == LoadErrorKind::broken) note_server(false);
  const auto server = context_.servers.find(location_.host());
  const bool known = server != context_.servers.end();
  const bool restarts =
      known && (error.kind == LoadErrorKind::unreachable || (error.kind == LoadErrorKind::broken && server->second));
  transient |= restarts;
  const unsigned most = restarts || retry_after ? options.max_reconnects : options.max_retries;
  const auto longest = std::chrono::duration_cast<std::chrono::seconds>(options.max_retry_after).count();
  const bool asks_too_much = retry_after && *retry_after > longest;
  if (!transient || asks_too_much || fetch.failures > most || fetch.attempts >= options.max_attempts) {
    std::string what = error.message;
    if (asks_too_much) what += "; retry in " + std::to_string(*retry_after) + " s";
    if (fetch.attempts > 1) what += " (after " + std::to_string(fetch.attempts) + " attempts)";
    return fail(error.kind, what, error.http_status);
  }
  Milliseconds delay =
      std::min(options.max_retry_delay, options.retry_delay * (1 << std::min(fetch.failures - 1, 10u)));
  // The random delay prevents that all clients of a failed server retry at the same time.
  delay -=
      Milliseconds(static_cast<std::int64_t>(context_.random() % static_cast<std::uint64_t>(delay.count() / 2 + 1)));
  if (retry_after) delay = std::max(delay, Milliseconds(*retry_after * 1000));
  fetch.not_before = now + delay;
  if (delivery_.received() > 0 && (version_.encoded || version_.validator.strong().empty()))
    return restart(error.kind, error.message + ", and the server gives no validator for its version", fetch.not_before);
  const RangeSet rest = delivery_.needed().within(fetch.range);
  fetch.finished = rest.empty();
  if (!fetch.finished) fetch.position = rest.ranges().front().begin;
  check_done();
}

}  // namespace gs::net
