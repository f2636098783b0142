// Adds fields to the list of settings under a name that grows with the groups they are in.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "slam/pipeline/setting_fields.h"

namespace penumbra::slam {

inline constexpr double kMany = 1e6;  // more than any sensible number of things

class FieldList {
 public:
  FieldList(std::string prefix, std::vector<SettingField>& fields)
      : prefix_(std::move(prefix)), fields_(fields) {}

  FieldList group(const char* name) const { return {fmt::format("{}{}.", prefix_, name), fields_}; }
  void flag(const char* name, bool& value) { fields_.push_back({prefix_ + name, "", &value}); }
  template <class Word>
  void word(const char* name, Word& value) {
    fields_.push_back({prefix_ + name, "", &value});
  }
  template <class Number>
  void number(const char* name, Number& value, const char* unit, double least, double most) {
    fields_.push_back({prefix_ + name, unit, &value, least, most});
  }
  // 0, which stands for what follows from the sensor, or a number from `least` on.
  template <class Number>
  void by_sensor(const char* name, Number& value, const char* unit, double least, double most) {
    fields_.push_back({prefix_ + name, unit, &value, least, most, /*or_zero=*/true});
  }
  void count(const char* name, int& value, const char* unit, double least = 0.0) {
    number(name, value, unit, least, kMany);
  }
  void share(const char* name, double& value) { number(name, value, "share", 0.0, 1.0); }
  void metres(const char* name, double& value) { number(name, value, "metres", 0.0, 1e4); }
  template <class Number>
  void pixels(const char* name, Number& value) {
    number(name, value, "pixels", 0.0, 1e4);
  }

 private:
  std::string prefix_;
  std::vector<SettingField>& fields_;
};

// The fields of what leaves out what moves.
void add_semantics(FieldList list, SemanticsSettings& settings);

}  // namespace penumbra::slam
