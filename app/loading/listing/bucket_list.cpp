#include "app/loading/listing/bucket_list.h"

#include "base/text.h"
#include "net/base/reference_policy.h"
#include "net/base/schemes.h"
#include "vrml/xml/expat_parser.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostKeyBytes = 1024;      // maximum bytes of a key in UTF-8 in all stores
constexpr std::size_t kMostTokenBytes = 4096;    // maximum bytes of the token of the next page
constexpr std::size_t kMostKeysOfPage = 10'000;  // stores send at most 1,000
constexpr std::size_t kMostListDepth = 8;            // of nested elements
constexpr std::string_view kListMark = "<ListBucketResult";

std::string percent_decoded(std::string_view text) {
  net::Url url;
  url.scheme = "file";
  url.path = "/" + std::string(text);
  const std::string path = net::path_of_url(url);
  return path.substr(std::min<std::size_t>(1, path.size()));
}

/// Decodes a key as stores encode it on request (EncodingType).
std::string decoded_key(std::string key) {
  std::ranges::replace(key, '+', ' ');
  return percent_decoded(key);
}

/// Encodes a text as the value of a query parameter (RFC 3986 2.3).
std::string query_value(std::string_view text) {
  std::string value;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                       c == '.' || c == '_' || c == '~';
    if (plain) {
      value += c;
      continue;
    }
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    const auto code = static_cast<unsigned char>(c);
    value += {'%', kDigits[code / 16], kDigits[code % 16]};
  }
  return value;
}

/// Parser of a page, element by element.
class PageParse {
 public:
  explicit PageParse(const WorldBudget& budget)
      : parser_(budget, {[this](std::string_view name, const char**) { begin(name); }, [this] { end(); },
                         [this](std::string_view text) { add(text); }}) {}

  std::variant<BucketPage, std::string> parse(std::string_view text) {
    const bool good = parser_.parse(text, true);
    if (!refusal_.empty()) return refusal_;
    if (!good) return parser_.error();
    if (is_encoded_) {
      const auto decode_all = [](std::vector<std::string>& all) {
        for (std::string& one : all) one = decoded_key(std::move(one));
      };
      decode_all(page_.keys);
      decode_all(page_.folders);
      page_.prefix = decoded_key(std::move(page_.prefix));
      marker_ = decoded_key(std::move(marker_));
    }
    if (!is_truncated_) return std::move(page_);
    // Version 1 has a marker only in lists with folders; otherwise the last key is the marker.
    if (!token_.empty())
      page_.next = "continuation-token=" + query_value(token_);
    else if (!marker_.empty() || !page_.keys.empty())
      page_.next = "marker=" + query_value(!marker_.empty() ? marker_ : page_.keys.back());
    return std::move(page_);
  }

 private:
  void refuse(const char* why) {
    refusal_ = why;
    parser_.stop();
  }
  void begin(std::string_view name) {
    if (open_.size() >= kMostListDepth) return refuse("elements are nested too deeply");
    if (open_.empty() && name != "ListBucketResult") return refuse("not the list of a bucket");
    open_.emplace_back(name.substr(0, kMostKeyBytes));
    text_.clear();
  }
  void add(std::string_view text) {
    // Keeps one byte more than permitted, so that end() notices longer texts.
    text_.append(text.substr(0, kMostTokenBytes + 1 - std::min(kMostTokenBytes + 1, text_.size())));
  }
  void end() {
    // Expat reports the end of an empty element even after begin() has stopped it.
    if (!refusal_.empty() || open_.empty()) return;
    const std::string name = std::move(open_.back());
    open_.pop_back();
    const std::string text = std::exchange(text_, {});
    if (open_.size() == 1) return take(name, text);
    if (open_.size() != 2 || text.empty() || text.size() > kMostKeyBytes) return;
    if (page_.keys.size() + page_.folders.size() >= kMostKeysOfPage) return refuse("more than 10,000 keys on a page");
    if (open_.back() == "Contents" && name == "Key") page_.keys.push_back(text);
    if (open_.back() == "CommonPrefixes" && name == "Prefix") page_.folders.push_back(text);
  }
  void take(const std::string& name, const std::string& text) {
    if (text.size() > kMostTokenBytes) return;
    if (name == "Prefix" && text.size() <= kMostKeyBytes) page_.prefix = text;
    if (name == "IsTruncated") is_truncated_ = text == "true";
    if (name == "NextContinuationToken") token_ = text;
    if (name == "NextMarker") marker_ = text;
    if (name == "EncodingType") is_encoded_ = text == "url";
  }

  vrml::xml::ExpatParser parser_;
  std::vector<std::string> open_;  // names of the open elements
  std::string text_, token_, marker_, refusal_;
  bool is_truncated_ = false, is_encoded_ = false;
  BucketPage page_;
};

net::Url without_query(net::Url url) {
  url.query.clear();
  url.fragment.clear();
  url.has_query = url.has_fragment = false;
  return url;
}

/// Returns true if a host of this name probably has several buckets, and paths begin with the bucket.
bool is_store_of_many(std::string_view authority) {
  const auto place = net::host_and_port(authority);
  if (!place) return false;
  const std::string host = lower_case(place->host);
  const bool is_address = host.find_first_not_of("0123456789.:") == std::string::npos;
  return is_address || host == "localhost" || host.starts_with("s3.") || host.starts_with("s3-") ||
         host == "storage.googleapis.com";
}

}  // namespace

bool is_bucket_list(std::span<const std::byte> first) {
  constexpr std::size_t kLookedAt = 512;
  const std::string_view text = text_of(first).substr(0, kLookedAt);
  const std::size_t start = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return start != std::string_view::npos && text[start] == '<' && text.find(kListMark) != std::string_view::npos;
}

std::variant<BucketPage, std::string> read_bucket_page(std::span<const std::byte> bytes, const WorldBudget& budget) {
  return PageParse(budget).parse(text_of(bytes));
}

std::vector<BucketPlace> bucket_places(const net::Url& url) {
  const net::Scheme* const scheme = net::find_scheme(url.scheme);
  if (!scheme || !scheme->buckets || url.has_query || url.authority.find('@') != std::string::npos ||
      !url.path.starts_with('/'))
    return {};
  const std::string path = percent_decoded(url.path.substr(1));
  std::vector<BucketPlace> places;
  BucketPlace by_host{without_query(url), path};
  by_host.bucket.path = "/";
  places.push_back(std::move(by_host));
  const std::size_t slash = url.path.find('/', 1);
  if (slash == std::string::npos) return places;
  BucketPlace by_path{without_query(url), percent_decoded(url.path.substr(slash + 1))};
  by_path.bucket.path = url.path.substr(0, slash + 1);
  places.insert(is_store_of_many(url.authority) ? places.begin() : places.end(), std::move(by_path));
  return places;
}

BucketPlace place_of_list(const net::Url& url, const BucketPage& page) {
  BucketPlace place{without_query(url), page.prefix};
  if (!place.bucket.path.ends_with('/')) place.bucket.path += '/';
  return place;
}

net::Url list_url(const BucketPlace& place, bool folders, const std::string& next) {
  net::Url url = place.bucket;
  // Removes the slash after the bucket: all stores accept that path, and some accept no other.
  if (url.path.size() > 1) url.path.pop_back();
  url.has_query = true;
  url.query = "list-type=2";
  if (folders) url.query += "&delimiter=%2F";
  url.query += "&prefix=" + query_value(place.prefix);
  return next.empty() ? url : next_list_url(url, next);
}

net::Url next_list_url(const net::Url& url, const std::string& next) {
  net::Url result = url;
  result.query.clear();
  const std::string_view name = std::string_view(next).substr(0, next.find('='));
  std::string_view rest = url.query;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view one = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (one.substr(0, one.find('=')) == name) continue;
    result.query += std::string(one) + '&';
  }
  result.query += next;
  result.has_query = true;
  return result;
}

net::Url object_url(const net::Url& bucket, const std::string& key) {
  net::Url url = bucket;
  // Keys may begin with a slash or contain "..", so the reference is not resolved.
  std::string path = net::reference_of_path("/" + key);
  url.path += path.substr(std::min<std::size_t>(1, path.size()));
  return url;
}

}  // namespace gs::app
