// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/round_robin/blind_protocol.h"

#include <fmt/format.h>

#include <utility>

#include "bench/report/number_format.h"

namespace todbench {
namespace {

Section measurand_section(const ProtocolFacts& facts) {
  Table items{.caption = "Items", .header = {"Item", "Set contrast (K)", "IFOV (mrad)", "Distance (m)"}, .rows = {}};
  for (const ReferenceCase& c : facts.cases)
    items.rows.push_back({plain(c.name), plain(stated(c.delta_t_k)), plain(significant(c.sensor.ifov_mrad(), 6)),
                          plain(stated(reference_distance_m))});
  return {
      "Measurand",
      {Paragraph{plain(fmt::format(
           "For each item: the triangle size S75, at which the observer {} names the direction of 75 % of the "
           "triangles, "
           "averaged over sampling phases, noise and directions. Size: square root of the area over the distance, in "
           "mrad. State it with its standard uncertainty u.",
           reference_observer))},
       std::move(items)}};
}

Section files_section(const ProtocolFacts& facts) {
  Table files{.caption = "Files", .header = {"File", "Content"}, .rows = {}};
  const SensorSpec& sensor = facts.cases.front().sensor;
  for (const auto& [name, content] : std::vector<std::pair<std::string, std::string>>{
           {"ITEM.tif", fmt::format("{} pages of 16 bits, counts linear in temperature: {} K + {} K per count",
                                    facts.frames, stated(sensor.offset_k), stated(sensor.kelvin_per_count))},
           {"ITEM.todrec", "the same frames as a recording of todbench"},
           {"ITEM-frames.csv", "plate, mounting and shift of each frame"},
           {"ITEM-triangles.csv", "size, direction and place of each triangle in each frame"},
           {"items.csv", "the items of this page"},
           {"plates/, observers/", "descriptions of the plates and of the observer, TOML"},
           {"SHA256SUMS", "SHA-256 of every other file"}})
    files.rows.push_back({plain(name), plain(content)});
  return {"Files", {std::move(files)}};
}

Section results_section(const ProtocolFacts& facts) {
  List rules;
  rules.items = {
      plain("Fill in results.csv: one row for each item. The columns are laboratory, item, quantity, value and u. "
            "Instead "
            "of u: expanded_u and k, or ci95_low and ci95_high."),
      plain("Send results.csv to the coordinator. A result cannot be changed after the true values are opened."),
      plain("todbench round-robin judge makes such a file with the observer of todbench."),
      plain("The results are evaluated by the weighted mean with a consistency check, E_n and degrees of equivalence "
            "(Cox "
            "2002; ISO 13528)."),
      plain("The coordinator keeps the true values in a sealed file. Its SHA-256 is " + facts.sealed_sha256 +
            ": whoever receives the file after the comparison can check that it is the same.")};
  return {"Results", {std::move(rules)}};
}

}  // namespace

Document blind_protocol(const ProtocolFacts& facts) {
  return {.title = "Protocol of an interlaboratory comparison",
          .heading = "Protocol of an interlaboratory comparison",
          .subtitle = facts.laboratory,
          .page_label = facts.laboratory,
          .opening = {Paragraph{plain(fmt::format("{} recordings of simulated thermal cameras whose properties are not "
                                                  "stated. The other laboratories have other "
                                                  "frames of the same cameras.",
                                                  facts.cases.size()))}},
          .sections = {measurand_section(facts), files_section(facts), results_section(facts)}};
}

}  // namespace todbench
