#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "net/base/range_set.h"
#include "net/base/reference_policy.h"
#include "net/base/schemes.h"
#include "net/http/http_headers.h"

namespace gs::net {

class MemoryNetwork;
class Transport;

/// Time that only goes forward, for time-outs and delays.
using TimePoint = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

/// Names a request; never given twice by one loader. 0 names none.
struct RequestId {
  std::uint64_t value = 0;
  friend auto operator<=>(const RequestId&, const RequestId&) = default;
};

enum class CacheUse {
  normal,      // as RFC 9111 says
  reload,      // ask the server; keep the answer
  never_store  // neither read nor write
};

/// What the loader is asked for.
struct Request {
  std::string url;                // absolute; a fragment is not sent
  std::vector<ByteRange> ranges;  // empty: the whole; else only these bytes, at most LoaderOptions::max_ranges of them
  int priority = 0;               // higher first
  std::uint32_t viewport = 0;     // who asks: among equal priorities the viewports take turns
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // more than so many bytes are refused, also decompressed ones
  std::string accept;                                // media types, as in the header Accept; empty: any
  Origin from;                                       // of the text that refers to it
  Validator validator;                               // when not empty: only bytes of this version are of use
  CacheUse cache = CacheUse::normal;
};

enum class LoadErrorKind {
  bad_request,         // a URL or ranges that cannot be
  forbidden,           // not for this document: by its URL, the address of its host, or where a server redirects to
  unsupported,         // a scheme without transport
  not_found,           // no such file, or status 404 or 410
  http_status,         // any other answer that is no success
  unreachable,         // no connection
  timed_out,           // no connection, no answer, or no more bytes in time
  broken,              // the connection ended early
  bad_response,        // not what the protocol allows
  insecure,            // TLS: the server cannot show who it is
  too_many_redirects,  //
  too_large,           // more bytes than the request allows
  changed,             // the resource changed while it was read
  unreadable           // a file that cannot be read
};

/// Why a request failed. The message names the URL (without password), what happened and what was expected.
struct LoadError {
  LoadErrorKind kind = LoadErrorKind::broken;
  std::string message;
  int http_status = 0;
};

/// The first event of a request: what is about to come.
struct LoadHead {
  std::string url;                            // after redirects
  std::optional<std::uint64_t> total;         // bytes of the whole resource
  std::string content_type;                   // as sent; empty where the transport knows none
  Validator validator;                        // the version that all data up to the next restart is of
  bool accepts_ranges = false;                // further ranges can be had without reading all before them
  bool from_cache = false;                    // the server was not asked, or said that nothing changed
  AddressSpace space = AddressSpace::global;  // of the host that sent it

  /// Of what comes, where it is a text.
  [[nodiscard]] Origin origin() const { return {url, space}; }
};
/// Bytes, each wanted byte once. Of one range they come in order, and all in order where the server knows no ranges.
struct LoadData {
  std::uint64_t offset = 0;  // of the first byte in the resource
  std::vector<std::byte> bytes;
};
/// All that was wanted has been handed out. Last event.
struct LoadDone {};
/// The resource has changed, or a broken transfer cannot be resumed: whatever came so far is void; a new head follows.
struct LoadRestarted {};

/// What happened to a request: a head; data; done or an error at the end. Nothing comes after the end or a cancel.
struct LoadEvent {
  RequestId id;
  std::variant<LoadHead, LoadData, LoadDone, LoadRestarted, LoadError> what;
};

/// How far a request, or all open ones, are.
struct LoadProgress {
  std::uint64_t received = 0;          // bytes, handed out or about to be
  std::optional<std::uint64_t> total;  // bytes wanted; none while some of them are not known
  std::size_t open = 0;                // requests without end
};

/// Bounds, time-outs and surroundings of a loader.
struct LoaderOptions {
  // Memory: bytes that have arrived and not been polled. Transfers wait beyond; each may overshoot by a block.
  std::size_t max_queued_bytes = std::size_t{8} << 20;
  std::size_t max_queued_bytes_per_request = std::size_t{4} << 20;
  std::size_t max_header_bytes = std::size_t{64} << 10;
  std::size_t max_ranges = 4096;
  // Transfers at once. A few more may be kept waiting half-way while more urgent ones run.
  unsigned max_transfers = 16;
  unsigned max_transfers_per_host = 6;
  std::uint64_t bytes_per_second = 0;  // of all transfers over HTTP and FTP together at most; 0: any
  std::uint64_t join_gap = 4096;       // ranges closer than this are asked for as one
  // Patience
  unsigned max_redirects = 10;
  unsigned max_retries = 3;    // without a byte of progress between
  unsigned max_attempts = 30;  // transfers of one range, whatever their progress
  unsigned max_restarts = 3;
  Milliseconds connect_timeout{10'000};
  Milliseconds head_timeout{30'000};   // from the start of a transfer to the end of the headers
  Milliseconds stall_timeout{20'000};  // without a byte of the body
  Milliseconds retry_delay{250};       // doubled each time, and shortened by chance to between a half and all of it
  Milliseconds max_retry_delay{8'000};
  Milliseconds max_retry_after{15'000};  // a server that asks for more is not waited for
  // Cache; without a folder there is none
  std::string cache_folder;
  std::uint64_t cache_bytes = std::uint64_t{2} << 30;
  std::size_t cache_entries = 4096;
  // Who may refer to what
  ReferencePolicy policy;
  AddressSpaceOf space_of = address_space_of;
  // Surroundings
  std::function<void()> wake;                  // called from the loader's threads when poll() has something new
  std::function<std::uint64_t()> random;       // 64 bits by chance; called from the network thread only
  std::function<std::int64_t()> unix_seconds;  // for the cache; called from the network thread only
  std::string user_agent = "GhostSpace";
  std::string ca_file;                    // certificates to trust in place of the system's
  bool proxy_from_environment = true;     // http_proxy, https_proxy, no_proxy
  std::shared_ptr<MemoryNetwork> memory;  // what memory: URLs name; none: the scheme is not supported
  /// Further transports for the network thread, made on it.
  std::vector<std::pair<TransportKind, std::function<std::unique_ptr<Transport>()>>> transports;
};

}  // namespace gs::net
