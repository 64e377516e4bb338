#include "net/base/url_signature.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace {

using namespace gs::net;

TEST_CASE("removes the signature of presigned URLs, and nothing else") {
  const std::string amazon =
      "X-Amz-Algorithm=AWS4-HMAC-SHA256&X-Amz-Credential=KEY%2F20261126%2Feu%2Fs3%2Faws4_request&X-Amz-Date="
      "20261126T180000Z"
      "&X-Amz-Expires=900&X-Amz-SignedHeaders=host&X-Amz-Signature=0123abcd";
  const std::pair<std::string, std::string> urls[] = {
      {"https://b.s3.example/a.qnv?" + amazon, "https://b.s3.example/a.qnv"},
      {"https://b.s3.example/a.qnv?versionId=7&" + amazon + "&x-id=GetObject#V",
       "https://b.s3.example/a.qnv?versionId=7&x-id=GetObject#V"},
      {"https://b.s3.example/a.qnv?x-amz-signature=1&x-amz-expires=2", "https://b.s3.example/a.qnv"},
      {"https://b.s3.example/a?AWSAccessKeyId=K&Expires=9&Signature=s%3D", "https://b.s3.example/a"},
      {"https://storage.example/b/a?X-Goog-Credential=c&X-Goog-Signature=s&generation=3",
       "https://storage.example/b/a?generation=3"},
      {"https://storage.example/b/a?GoogleAccessId=i&Expires=9&Signature=s", "https://storage.example/b/a"},
      {"https://d1.example/a.qnv?Policy=p&Signature=s&Key-Pair-Id=K", "https://d1.example/a.qnv"},
      {"https://x.blob.example/c/a?sv=2024&sr=b&sp=r&se=2027&sig=s%3D&snapshot=2",
       "https://x.blob.example/c/a?snapshot=2"},
  };
  for (const auto& [url, rest] : urls) {
    CHECK(without_signature(url) == rest);
    CHECK(is_presigned(url));
  }
}

TEST_CASE("keeps URLs and paths without a signature as they are") {
  for (const char* const url :
       {"https://host/a?Signature=1", "https://host/a?sig=1", "https://host/a?Expires=9&token=x", "https://host/a?",
        "https://host/a#?X-Amz-Signature=1", "/files/what?X-Amz-Signature=1", "a?X-Amz-Signature=1", "", "?",
        "https://h/?&&", "https://host/a?b=X-Amz-Signature=1"}) {
    CHECK(without_signature(url) == url);
    CHECK_FALSE(is_presigned(url));
  }
}

}  // namespace
