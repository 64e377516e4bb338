#include "net/base/url_signature.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <vector>

namespace gs::net {
namespace {

/// Kind of signature in the query of a URL. Names are in lower case, because servers spell them in different cases.
struct SignatureKind {
  // Names that a signed URL must have. `second` may be empty.
  std::string_view first, second;
  std::string_view prefix;                    // all names with this prefix belong to the signature; may be empty
  std::span<const std::string_view> names{};  // names that belong to the signature, besides `first` and `second`
};

constexpr std::string_view kAmazonV2[] = {"expires", "x-amz-security-token"};
constexpr std::string_view kGoogleV2[] = {"expires"};
constexpr std::string_view kCloudFront[] = {"expires", "policy", "hash-algorithm"};
// https://learn.microsoft.com/rest/api/storageservices/create-service-sas
constexpr std::string_view kAzure[] = {"ss",    "srt", "sp",  "st",  "se",  "sip", "spr", "si",    "sr",    "skoid",
                                       "sktid", "skt", "ske", "sks", "skv", "ses", "sdd", "saoid", "suoid", "scid"};
constexpr SignatureKind kSignatureKinds[] = {
    {"x-amz-signature", "", "x-amz-"},
    {"signature", "awsaccesskeyid", "", kAmazonV2},
    {"x-goog-signature", "", "x-goog-"},
    {"signature", "googleaccessid", "", kGoogleV2},
    {"signature", "key-pair-id", "", kCloudFront},
    {"sig", "sv", "", kAzure},
};

struct Parameter {
  std::string_view text;  // "NAME=VALUE"
  std::string name;       // in lower case
};

std::vector<Parameter> parameters_of(std::string_view query) {
  std::vector<Parameter> result;
  for (std::size_t begin = 0; begin <= query.size();) {
    const std::size_t end = std::min(query.find('&', begin), query.size());
    const std::string_view text = query.substr(begin, end - begin);
    result.push_back({text, lower_case(text.substr(0, std::min(text.find('='), text.size())))});
    begin = end + 1;
  }
  return result;
}

const SignatureKind* kind_of(const std::vector<Parameter>& parameters) {
  const auto has = [&](std::string_view name) {
    return name.empty() || std::ranges::any_of(parameters, [&](const Parameter& one) { return one.name == name; });
  };
  const auto found = std::ranges::find_if(kSignatureKinds,
                                          [&](const SignatureKind& one) { return has(one.first) && has(one.second); });
  return found == std::end(kSignatureKinds) ? nullptr : &*found;
}

}  // namespace

std::string without_signature(std::string_view url) {
  const std::size_t fragment = std::min(url.find('#'), url.size()), mark = url.find('?');
  if (mark >= fragment || url.find("://") > mark) return std::string(url);
  const std::vector<Parameter> parameters = parameters_of(url.substr(mark + 1, fragment - mark - 1));
  const SignatureKind* const kind = kind_of(parameters);
  if (!kind) return std::string(url);
  std::string result(url.substr(0, mark));
  char before = '?';
  for (const Parameter& one : parameters) {
    const bool signs = one.name == kind->first || one.name == kind->second ||
                       (!kind->prefix.empty() && one.name.starts_with(kind->prefix)) ||
                       std::ranges::find(kind->names, one.name) != kind->names.end();
    if (signs) continue;
    result += before;
    result += one.text;
    before = '&';
  }
  return result.append(url.substr(fragment));
}

bool is_presigned(std::string_view url) { return without_signature(url).size() != url.size(); }

}  // namespace gs::net
