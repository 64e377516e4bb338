#include <algorithm>
#include <array>

#include "net/load/load_job.h"

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

}  // namespace

HeadVerdict LoadJob::on_head(Fetch& fetch, const ResponseHead& head) {
  fetch.answer = {};
  if (const auto why = refuse_host(reach_, head.space)) {
    fail(LoadErrorKind::forbidden, *why);
    return HeadVerdict::stop;
  }
  fetch.answer.space = head.space;
  if (is_redirect(head.status) && !head.location.empty()) {
    fetch.answer.redirect = head.location;
    return HeadVerdict::discard;
  }
  if (head.status == 304 && fetch.conditional && cached_) {
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
  if (cached_ && !head_sent_) {
    restart(LoadErrorKind::changed, "it became shorter", {});
  } else if (total && (head_sent_ ? !total_ : fetch.position == 0 && *total == 0)) {
    fetch.finished = true;
    stop(fetch);
    if (head_sent_) {
      total_ = total;
      if (clamp()) check_done();
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

/// Checks whether a response fits the request. Otherwise fails the job and returns false.
bool LoadJob::check_answer(Fetch& fetch, const ResponseHead& head) {
  const auto bad = [this](const std::string& what) {
    fail(LoadErrorKind::bad_response, what);
    return false;
  };
  if (!request_.validator.empty() && !request_.validator.agrees(head.validator)) {
    fail(LoadErrorKind::changed, "it is no longer the requested version");
    return false;
  }
  if (head.status != 206) return true;
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
  return true;
}

/// Keeps the cached bytes if `proven`, that is, if the server's version equals the cached version. Otherwise drops
/// them.
void LoadJob::settle_cached(const ResponseHead& head, bool proven) {
  if (proven) {
    context_.cache->confirm(key(), version_, freshness(head), context_.unix_seconds());
    trusted_ = true;
  } else {
    cached_.reset();
    version_ = {};
    total_.reset();
    encoded_ = false;
  }
}

HeadVerdict LoadJob::accept(Fetch& fetch, const ResponseHead& head) {
  if (!check_answer(fetch, head)) return HeadVerdict::stop;
  const bool whole_body = head.status != 206;
  const auto total = whole_body ? head.content_length : head.content_range->total;
  const bool agrees = version_.agrees(head.validator) && (!total_ || !total || *total_ == *total);
  const bool proven = agrees && !encoded_ && !head.encoded && !version_.strong().empty() &&
                      version_.strong() == head.validator.strong();
  if (cached_ && !trusted_) {
    if (!proven && !whole_body) {
      restart(LoadErrorKind::changed, "it changed since it was cached", {});
      return HeadVerdict::stop;
    }
    settle_cached(head, proven);
  } else if (head_sent_ && (!agrees || (whole_body && received_ > 0 && !proven))) {
    restart(
        LoadErrorKind::changed,
        agrees ? "the server cannot resume an interrupted transfer" : "it changed on the server during the transfer",
        {});
    return HeadVerdict::stop;
  }
  if (!head_sent_) adopt(head, total);
  if (over_) return HeadVerdict::stop;
  // A name may later resolve to another address. Refuse later responses from a more private host.
  reach_ = std::max(reach_, head.space);
  if (!total_ && total) {
    total_ = total;
    if (!clamp()) return HeadVerdict::stop;
  }
  fetch.answer.whole = whole_body;
  if (whole_body) {
    // This body contains all requested bytes in order, so stop the other transfers.
    for (const auto& other : fetches_)
      if (other.get() != &fetch) {
        stop(*other);
        other->finished = true;
      }
    fetch.position = 0;
    fetch.range = {0, whole() ? kOpenEnd : needed_.empty() ? 0 : needed_.ranges().back().end};
    fetch.answer.end = head.content_length;
  } else {
    fetch.answer.end = head.content_range->end;
    plan_what_is_missing();
  }
  open_writer(head);
  return HeadVerdict::take;
}

/// Makes the version of this response the current version.
void LoadJob::adopt(const ResponseHead& head, std::optional<std::uint64_t> total) {
  if (!cached_) {
    version_ = head.validator;
    encoded_ = head.encoded;
    space_ = head.space;
  }
  space_ = std::max(space_, head.space);
  if (total) total_ = total;
  accepts_ranges_ = head.accepts_ranges && !head.encoded;
  if (accepts_ranges_) {
    constexpr std::size_t kMax = 1024;
    if (context_.ranges_known.size() >= kMax) context_.ranges_known.clear();
    context_.ranges_known[url_] = true;
  }
  emit_head({url_, total_, head.content_type, version_, accepts_ranges_, cached_.has_value(), space_});
}

void LoadJob::open_writer(const ResponseHead& head) {
  if (writer_ || !may_cache()) return;
  if (head.cache_control.no_store || head.other_answers) return context_.cache->drop(key());
  const std::int64_t fresh_for = freshness(head);
  if (version_.empty() && fresh_for == 0) return;
  writer_ = context_.cache->write(key(), {url_, head.content_type, version_, total_, accepts_ranges_, encoded_,
                                          context_.unix_seconds(), fresh_for, space_});
}

DataVerdict LoadJob::on_data(Fetch& fetch, std::span<const std::byte> bytes) {
  const std::uint64_t begin = fetch.position + fetch.answer.held.size();
  const std::uint64_t end = begin + bytes.size();
  if (end < begin || (fetch.answer.end && end > *fetch.answer.end)) {
    fail(LoadErrorKind::bad_response,
         "the server sent more than the " + std::to_string(fetch.answer.end.value_or(0)) + " bytes it announced");
    return DataVerdict::stop;
  }
  if (whole() && !cached_pending().empty()) {
    fetch.answer.held.insert(fetch.answer.held.end(), bytes.begin(), bytes.end());
    return DataVerdict::pause;
  }
  return deliver(fetch, bytes);
}

DataVerdict LoadJob::deliver(Fetch& fetch, std::span<const std::byte> bytes) {
  const std::uint64_t begin = fetch.position, end = begin + bytes.size();
  const RangeSet pieces = needed_.within(ByteRange{begin, end});
  if (pieces.size() > request_.max_bytes - std::min(request_.max_bytes, received_)) {
    fail(LoadErrorKind::too_large, "more than " + std::to_string(request_.max_bytes) + " bytes were received" +
                                       (encoded_ ? " after decompression" : "") + ", the limit of this request");
    return DataVerdict::stop;
  }
  if (writer_) writer_->append(begin, bytes);
  for (const ByteRange& piece : pieces.ranges()) {
    received_ += piece.size();
    context_.queue.push_data(
        id_, piece.begin,
        bytes.subspan(static_cast<std::size_t>(piece.begin - begin), static_cast<std::size_t>(piece.size())));
  }
  needed_.subtract({begin, end});
  fetch.position = end;
  if (!pieces.empty()) fetch.failures = 0;
  const bool more_wanted = !needed_.within(ByteRange{end, fetch.range.end}).empty();
  const bool nearly_over = fetch.answer.end && *fetch.answer.end - end <= kWorthReading;
  if (!more_wanted && !nearly_over) {
    fetch.finished = true;
    stop(fetch);
    check_done();
    return DataVerdict::stop;
  }
  return context_.queue.room(id_) == 0 ? DataVerdict::pause : DataVerdict::more;
}

void LoadJob::on_end(Fetch& fetch, const TransferEnd& end, TimePoint now) {
  fetch.transfer = 0;
  if (!fetch.answer.held.empty()) {
    fetch.answer.held_end = end;
    return;
  }
  const Fetch::Answer& answer = fetch.answer;
  if (!answer.redirect.empty()) return follow(std::string(answer.redirect), answer.space);
  if (answer.not_modified) return use_confirmed(fetch);
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
    if (total_ && !needed_.empty() && fetch.position < *total_) return broken(*total_);
    if (!total_) {
      total_ = fetch.position;
      if (!clamp()) return;
    }
  }
  const RangeSet rest = needed_.within(ByteRange{fetch.position, fetch.range.end});
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
  constexpr std::size_t kLongest = 8192;
  if (redirects_ >= context_.options.max_redirects)
    return fail(LoadErrorKind::too_many_redirects,
                "too many redirects; expected at most " + std::to_string(redirects_) + " redirects");
  if (location.size() > kLongest) return fail(LoadErrorKind::bad_response, "the server redirects to an invalid URL");
  const Url target = resolve(parse_url(url_), parse_url(tidy_url(location)));
  const Scheme* const scheme = find_scheme(target.scheme);
  // memory: URLs may redirect to memory: URLs, for tests.
  const bool within_memory = scheme && scheme == scheme_ && scheme->transport == TransportKind::memory;
  if (!scheme || (!scheme->redirect_target && !within_memory))
    return fail(LoadErrorKind::forbidden,
                "the server redirects to " + url_for_messages(target.text()) + "; expected http or https");
  // The redirect has the same rights as a document of that server.
  reach_ = std::max(reach_, Origin{url_, space}.reach());
  if (const auto why = context_.options.policy.refuse({url_, space}, target))
    return fail(LoadErrorKind::forbidden,
                "the server redirects to " + url_for_messages(target.text()) + ": " + why->message);
  const bool sent = head_sent_;
  if (sent && !void_version(LoadErrorKind::changed, "the server started to redirect during the transfer")) return;
  stop_all();
  ++redirects_;
  set_url(target.text());
  if (const auto why = refusal()) return fail(LoadErrorKind::bad_response, *why);
  use_cache_ = !sent;
  open_version();
}

/// Handles status 304: the cached version is still valid.
void LoadJob::use_confirmed(Fetch& fetch) {
  const ResponseHead head = *fetch.answer.not_modified;
  fetch.answer = {};
  fetch.finished = true;
  const bool says = head.cache_control.max_age || head.expires || head.cache_control.no_cache;
  context_.cache->confirm(key(), version_, says ? freshness(head) : cached_->head().fresh_for, context_.unix_seconds());
  trusted_ = true;
  space_ = std::max(space_, head.space);
  emit_head({url_, total_, cached_->head().content_type, version_, accepts_ranges_, true, space_});
  check_done();
}

void LoadJob::retry(Fetch& fetch, const LoadError& error, bool transient, std::optional<std::int64_t> retry_after,
                    TimePoint now) {
  const LoaderOptions& options = context_.options;
  fetch.answer = {};
  ++fetch.failures;
  // If the server has sent bytes before, it may be restarting, so retry.
  transient |= error.kind == LoadErrorKind::unreachable && received_ > 0;
  const auto longest = std::chrono::duration_cast<std::chrono::seconds>(options.max_retry_after).count();
  const bool asks_too_much = retry_after && *retry_after > longest;
  if (!transient || asks_too_much || fetch.failures > options.max_retries || fetch.attempts >= options.max_attempts) {
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
  if (received_ > 0 && (encoded_ || version_.strong().empty()))
    return restart(error.kind, error.message + ", and the server gives no validator for its version", fetch.not_before);
  const RangeSet rest = needed_.within(fetch.range);
  fetch.finished = rest.empty();
  if (!fetch.finished) fetch.position = rest.ranges().front().begin;
  check_done();
}

}  // namespace gs::net
