#include "vrml/scene/values/field_value.h"

#include "vrml/scene/values/field_numbers.h"

#include <catch2/catch.hpp>

using namespace gs;
using namespace gs::vrml;

TEST_CASE("begins matrices as the identity, and vectors and doubles as zero") {
  CHECK(*std::get<SFMatrix3f>(initial_value(FieldType::SFMatrix3f)) == glm::mat3(1));
  CHECK(*std::get<SFMatrix4d>(initial_value(FieldType::SFMatrix4d)) == glm::dmat4(1));
  CHECK(*std::get<SFVec3d>(initial_value(FieldType::SFVec3d)) == glm::dvec3(0));
  CHECK(std::get<SFVec4f>(initial_value(FieldType::SFVec4f)) == glm::vec4(0));
  CHECK(std::get<SFDouble>(initial_value(FieldType::SFDouble)) == 0.0);
  CHECK(std::get<SFColorRGBA>(initial_value(FieldType::SFColorRGBA)) == ColorRGBA{0, 0, 0, 0});
}

TEST_CASE("copies a boxed value when one of its owners changes it") {
  SFMatrix4f a(glm::mat4(2));
  SFMatrix4f b = a;
  CHECK(a == b);
  b.edit()[3][0] = 7;
  CHECK((*a)[3][0] == 0);
  CHECK((*b)[3][0] == 7);
  CHECK_FALSE(a == b);
  CHECK(SFMatrix4f() == SFMatrix4f(glm::mat4(1)));
  SFVec3d untouched;
  untouched.edit().x = 1;
  CHECK(*untouched == glm::dvec3(1, 0, 0));
  CHECK(*SFVec3d() == glm::dvec3(0));
}

TEST_CASE("counts, reads and writes the numbers of each type") {
  double numbers[kMaxNumbers];
  for (int i = 0; i < kMaxNumbers; ++i) numbers[i] = i + 1;
  for (int i = 0; i < kFieldTypeCount; ++i) {
    const auto type = static_cast<FieldType>(i);
    INFO(name_of(type));
    FieldValue value = initial_value(type);
    write_numbers(value, numbers);
    CHECK(type_of(value) == type);
    const bool plain = number_count(type) > 0;
    CHECK((value == initial_value(type)) == !plain);
    if (is_multiple(type)) {
      CHECK(element_count(value) == (plain ? 1 : 0));
      continue;
    }
    double read[kMaxNumbers] = {};
    read_numbers(value, read);
    for (int k = 0; k < number_count(type); ++k) CHECK(read[k] == k + 1);
  }
  CHECK(number_count(FieldType::MFMatrix3d) == 9);
  CHECK(number_count(FieldType::SFMatrix4f) == 16);
  CHECK(number_count(FieldType::SFColorRGBA) == 4);
  CHECK(number_count(FieldType::MFImage) == 0);
}
