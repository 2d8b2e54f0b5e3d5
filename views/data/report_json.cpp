#include <febiodea/views/data/report_json.h>

#include <fmt/format.h>

#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/version.h>
#include <febiodea/views/data/csv.h>
#include <febiodea/views/text/report_text.h>

namespace dea {

namespace {

Json json_vector6_head(const Vector6& v) { return json_vector(v.head<3>()); }
Json json_vector6_tail(const Vector6& v) { return json_vector(v.tail<3>()); }

Json json_map(const std::map<std::string, double>& values) {
  Json j = Json::object();
  for (const auto& entry : values) j[entry.first] = json_number(entry.second);
  return j;
}

Json body_json(const Body& body, const Pose& pose, const Vector6& reaction) {
  const Eigen::AngleAxisd turn(pose.rotation);
  Json j;
  j["translation"] = json_vector(pose.center - body.center_of_mass);
  j["rotation"] = json_vector(turn.angle() * turn.axis());
  j["force"] = json_vector6_head(reaction);
  j["moment"] = json_vector6_tail(reaction);
  return j;
}

Json contact_json(const Joint& joint, const ContactPair& pair, const ContactStatistics& s,
                  const ContactFields& fields) {
  Json j;
  j["name"] = pair.name;
  j["source"] = joint.bodies[at(pair.source_layer().body)].name;
  j["target"] = joint.bodies[at(pair.target_layer().body)].name;
  j["springs"] = s.springs;
  j["springs_active"] = s.springs_active;
  j["peak_pressure"] = json_number(s.peak);
  j["p99_pressure"] = json_number(s.p99);
  j["mean_pressure"] = json_number(s.mean);
  j["median_pressure"] = json_number(s.median);
  j["contact_area"] = json_number(s.contact_area);
  j["facet_peak_pressure"] = json_number(s.facet_peak);
  j["nodal_peak_pressure"] = json_number(s.nodal_peak);
  j["nodal_mean_pressure"] = json_number(s.nodal_mean);
  j["nodal_median_pressure"] = json_number(s.nodal_median);
  j["facet_contact_area"] = json_number(s.facet_contact_area);
  j["center_of_pressure"] = json_vector(s.center_of_pressure);
  j["force"] = json_vector(s.force);
  j["moment"] = json_vector(s.moment);
  j["springs_hit"] = s.springs_hit;
  j["p5_pressure"] = json_number(s.p5);
  j["p25_pressure"] = json_number(s.p25);
  j["p75_pressure"] = json_number(s.p75);
  j["p95_pressure"] = json_number(s.p95);
  j["largest_strain"] = json_number(s.largest_strain);
  j["source_resultant_factor"] = json_number(fields.sides[pair.source].resultant_factor);
  j["target_resultant_factor"] = json_number(fields.sides[1 - pair.source].resultant_factor);
  j["complementarity"] = json_number(s.complementarity);
  j["law"] = name(pair.law);
  j["facets"] = name(pair.facets);
  j["refine"] = pair.refine;
  return j;
}

Json state_json(const Joint& joint, const StateResult& state) {
  const Equilibrium& e = state.equilibrium;
  Json j;
  j["time"] = json_number(state.when.time);
  j["outcome"] = name(e.outcome);
  j["iterations"] = e.iterations;
  j["residual_force"] = json_number(e.residual_force);
  j["residual_moment"] = json_number(e.residual_moment);
  j["bodies"] = Json::object();
  for (int b : reported_bodies(joint))
    j["bodies"][joint.bodies[at(b)].name] = body_json(joint.bodies[at(b)], e.poses[at(b)], e.reaction[at(b)]);
  j["contacts"] = Json::array();
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    j["contacts"].push_back(contact_json(joint, joint.contacts[c], state.statistics[c], state.fields[c]));
  j["message"] = outcome_text(e);
  j["step"] = state.when.step + 1;
  j["load"] = json_number(e.load);
  j["residual_history"] = Json::array();
  for (double r : e.history) j["residual_history"].push_back(json_number(r));
  j["held_directions"] = e.held;
  j["least_stiffness"] = json_number(e.least_stiffness);
  j["ligaments"] = Json::array();
  for (std::size_t l = 0; l < e.ligament_force.size() && l < joint.ligaments.size(); ++l) {
    Json ligament;
    ligament["name"] = joint.ligaments[l].name;
    ligament["force"] = json_number(e.ligament_force[l]);
    j["ligaments"].push_back(ligament);
  }
  j["cables"] = Json::array();
  for (std::size_t c = 0; c < e.cable_force.size() && c < joint.cables.size(); ++c) {
    Json cable;
    cable["name"] = joint.cables[c].name;
    cable["force"] = json_number(e.cable_force[c]);
    j["cables"].push_back(cable);
  }
  j["joints"] = Json::array();
  for (std::size_t c = 0; c < e.connector_force.size() && c < joint.connectors.size(); ++c) {
    const Connector& connector = joint.connectors[c];
    Json item;
    item["name"] = connector.name;
    item["type"] = connector.type;
    item["body_a"] = joint.bodies[at(connector.body_a)].name;
    item["body_b"] = joint.bodies[at(connector.body_b)].name;
    item["force"] = json_vector6_head(e.connector_force[c]);
    item["moment"] = json_vector6_tail(e.connector_force[c]);
    item["translation"] = json_vector6_head(e.connector_motion[c]);
    item["rotation"] = json_vector6_tail(e.connector_motion[c]);
    j["joints"].push_back(item);
  }
  return j;
}

}  // namespace

Json json_number(double x) { return std::isfinite(x) ? Json(x + 0.0) : Json(nullptr); }  // + 0.0: no -0.0

Json json_vector(const Vector3d& v) { return Json::array({json_number(v[0]), json_number(v[1]), json_number(v[2])}); }

Json settings_json(const Settings& s) {
  Json j;
  j["contact"] = s.contact.empty() ? Json(nullptr) : Json(s.contact);
  j["source"] = s.source.empty() ? Json(nullptr) : Json(s.source);
  j["springs_at"] = name(s.springs_at);
  j["law"] = s.law ? Json(name(*s.law)) : Json(nullptr);
  j["layer_terms"] = s.layer_fit == LayerFit::OneTerm ? 1 : 2;
  j["interface_stiffness"] = s.interface_stiffness ? json_number(*s.interface_stiffness) : Json(nullptr);
  j["refine"] = s.refine ? Json(*s.refine) : Json(nullptr);
  j["rigid"] = s.rigid;
  j["keep_facets"] = s.keep_facets;
  j["attach"] = Json::object();
  for (const auto& entry : s.attach) j["attach"][entry.first] = entry.second;
  j["bone"] = Json::object();
  for (const auto& entry : s.bone) j["bone"][entry.first] = entry.second;
  j["thickness"] = json_map(s.thickness);
  j["E"] = json_map(s.E);
  j["nu"] = json_map(s.nu);
  j["free"] = Json::object();
  for (const auto& entry : s.free) {
    Json dofs = Json::array();
    for (std::size_t k = 0; k < kDofs; ++k)
      if (entry.second[k]) dofs.push_back(kDofNames[k]);
    j["free"][entry.first] = dofs;
  }
  j["force"] = Json::object();
  for (const auto& entry : s.force) j["force"][entry.first] = json_vector(entry.second);
  j["load_at"] = Json::object();
  for (const auto& entry : s.load_at)
    j["load_at"][entry.first] = entry.second.sphere_center ? Json("sphere-center") : json_vector(entry.second.point);
  j["squash"] = s.squash;
  j["facets"] = s.facets ? Json(name(*s.facets)) : Json(nullptr);
  return j;
}

Json run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings) {
  const Joint& joint = analysis.joint;
  Json j;
  j["schema"] = "dea.run/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  Json seconds;
  seconds["read"] = timings.read;
  seconds["joint"] = timings.joint;
  seconds["solve"] = timings.solve;
  seconds["write"] = timings.write;
  seconds["total"] = timings.total;
  j["timings"] = seconds;
  j["bodies"] = Json::array();
  for (int b : reported_bodies(joint)) j["bodies"].push_back(joint.bodies[at(b)].name);
  j["states"] = Json::array();
  for (const StateResult& state : analysis.states) j["states"].push_back(state_json(joint, state));
  j["units"] = model.units.empty() ? Json(nullptr) : Json(model.units);
  std::vector<std::string> findings = model_remarks(model, joint);
  for (const std::string& line : result_remarks(model, analysis)) findings.push_back(line);
  j["findings"] = findings;
  return j;
}

Json converge_json(const JointModel& model, const Settings& settings, const std::vector<Convergence>& studies,
                   double target, int max_springs) {
  Json j;
  j["schema"] = "dea.converge/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  j["settings"].erase("refine");  // it is what the study varies
  j["target"] = target;
  j["max_springs"] = max_springs;
  j["contacts"] = Json::array();
  for (const Convergence& study : studies) {
    Json c;
    c["name"] = study.contact;
    c["springs_5_percent"] = study.springs_5_percent < 0 ? Json(nullptr) : Json(study.springs_5_percent);
    c["springs_1_percent"] = study.springs_1_percent < 0 ? Json(nullptr) : Json(study.springs_1_percent);
    c["rows"] = Json::array();
    for (const ConvergenceRow& row : study.rows) {
      Json r;
      r["refine"] = row.refine;
      r["springs"] = row.springs;
      r["springs_hit"] = row.springs_hit;
      r["springs_active"] = row.springs_active;
      r["outcome"] = name(row.outcome);
      r["peak_pressure"] = json_number(row.peak);
      r["mean_pressure"] = json_number(row.mean);
      r["contact_area"] = json_number(row.area);
      r["change_peak"] = json_number(row.change_peak);
      r["change_mean"] = json_number(row.change_mean);
      r["change_area"] = json_number(row.change_area);
      c["rows"].push_back(r);
    }
    j["contacts"].push_back(c);
  }
  return j;
}

std::string json_text(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string run_csv(const JointModel&, const Analysis& analysis) {
  const Joint& joint = analysis.joint;
  std::string text =
      "time,contact,outcome,iterations,residual_force,residual_moment,source,target,springs,springs_hit,springs_active,"
      "peak_pressure,p99_pressure,mean_pressure,median_pressure,p5_pressure,p25_pressure,p75_pressure,p95_pressure,"
      "contact_area,"
      "facet_peak_pressure,nodal_peak_pressure,nodal_mean_pressure,nodal_median_pressure,facet_contact_area,"
      "center_of_pressure_x,center_of_pressure_y,center_of_pressure_z,force_x,force_y,force_z,moment_x,moment_y,moment_"
      "z,"
      "largest_strain,source_resultant_factor,target_resultant_factor\n";
  for (const StateResult& state : analysis.states) {
    for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
      const ContactPair& pair = joint.contacts[c];
      const ContactStatistics& s = state.statistics[c];
      text += fmt::format(
          "{},{},{},{},{},{},{},{},{},{},{}", csv_number(state.when.time), csv_word(pair.name),
          name(state.equilibrium.outcome), state.equilibrium.iterations, csv_number(state.equilibrium.residual_force),
          csv_number(state.equilibrium.residual_moment), csv_word(joint.bodies[at(pair.source_layer().body)].name),
          csv_word(joint.bodies[at(pair.target_layer().body)].name), s.springs, s.springs_hit, s.springs_active);
      for (double x : {s.peak, s.p99, s.mean, s.median, s.p5, s.p25, s.p75, s.p95, s.contact_area, s.facet_peak,
                       s.nodal_peak, s.nodal_mean, s.nodal_median, s.facet_contact_area})
        text += fmt::format(",{}", csv_number(x));
      for (const Vector3d& v : {s.center_of_pressure, s.force, s.moment})
        for (int k = 0; k < 3; ++k) text += fmt::format(",{}", csv_number(v[k]));
      for (double x : {s.largest_strain, state.fields[c].sides[pair.source].resultant_factor,
                       state.fields[c].sides[1 - pair.source].resultant_factor})
        text += fmt::format(",{}", csv_number(x));
      text += '\n';
    }
  }
  return text;
}

namespace {

/// Of the facets of a surface, in the reference configuration.
struct FacetShape {
  std::vector<double> area;
  std::vector<Vector3d> centroid;
  std::vector<double> thickness;  ///< of the surface's layer, mean over the facet
};

FacetShape facet_shape(const JointModel& model, const Layer& layer, const std::vector<double>& vertex_thickness) {
  const Surface& surface = model.surfaces[at(layer.surface)];
  const std::size_t n = at(surface.size());
  FacetShape out{std::vector<double>(n, 0.0), std::vector<Vector3d>(n, Vector3d::Zero()), std::vector<double>(n, 0.0)};
  const SurfaceMesh& mesh = layer.articular;
  for (int t = 0; t < mesh.size(); ++t) {
    const std::size_t f = at(mesh.facet[at(t)]);
    const double area = mesh.areas[at(t)];
    out.area[f] += area;
    out.centroid[f] += area * mesh.centroid(t);
    for (int vertex : mesh.triangles[at(t)]) out.thickness[f] += area / 3.0 * vertex_thickness[at(vertex)];
  }
  for (std::size_t f = 0; f < n; ++f) {
    if (out.area[f] > 0) {
      out.centroid[f] /= out.area[f];
      out.thickness[f] /= out.area[f];
      continue;
    }
    const int begin = surface.begin[f], count = surface.begin[f + 1] - begin;  // a facet of no area
    for (int k = 0; k < count; ++k) out.centroid[f] += model.nodes[at(surface.nodes[at(begin + k)])] / count;
    out.thickness[f] = std::nan("");
  }
  return out;
}

}  // namespace

std::string facets_csv(const JointModel& model, const Analysis& analysis) {
  const Joint& joint = analysis.joint;
  std::string text =
      "time,outcome,contact,surface,body,facet,reference_x,reference_y,reference_z,x,y,z,area,pressure,thickness,"
      "joint_space,overlap,strain\n";
  for (const StateResult& state : analysis.states) {
    for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
      for (int side = 0; side < 2; ++side) {
        const Layer& layer = joint.contacts[c].layers[side];
        const SideFields& fields = state.fields[c].sides[side];
        const Body& body = joint.bodies[at(layer.body)];
        const Pose& pose = state.equilibrium.poses[at(layer.body)];
        const FacetShape shape = facet_shape(model, layer, fields.vertex_thickness);
        const std::string start = fmt::format("{},{},{},{},{}", csv_number(state.when.time),
                                              name(state.equilibrium.outcome), csv_word(joint.contacts[c].name),
                                              csv_word(model.surfaces[at(layer.surface)].name), csv_word(body.name));
        for (std::size_t f = 0; f < shape.area.size(); ++f) {
          const Vector3d now = pose.center + pose.rotation * (shape.centroid[f] - body.center_of_mass);
          text += fmt::format("{},{}", start, f + 1);
          for (const Vector3d& v : {shape.centroid[f], now})
            for (int k = 0; k < 3; ++k) text += fmt::format(",{}", csv_number(v[k]));
          for (double x : {shape.area[f], fields.pressure[f], shape.thickness[f], fields.joint_space[f],
                           fields.overlap[f], fields.strain[f]})
            text += fmt::format(",{}", csv_number(x));
          text += '\n';
        }
      }
    }
  }
  return text;
}

}  // namespace dea
