// What a contact of type dea says of itself, as a dea::Contact.
#include <FECore/FEMesh.h>
#include <FECore/FEModel.h>
#include <FECore/FESurfaceMap.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/convert/xml_places.h"
#include "io/febio/febio_rules.h"
#include "plugin/dea_contact.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"

namespace {

using dea::at;

constexpr double kNotGiven = -1.0;  // a thickness that says nothing

/// A contact of type dea as its file has it: FEBio's reader keeps no lines, and takes "11,85" for 11.
struct ParameterInFile {
  std::string text, type;  ///< type: the attribute
  int line = 0;
};

/// The contact's parameters by their names. Empty where they are not found: the contact is in an included file, the
/// file is none of FEBio's XML (a dump of a run), or cannot be read.
std::map<std::string, ParameterInFile> contact_in_file(const std::string& path, const std::string& contact) {
  std::ifstream in(path, std::ios::binary);
  if (!in || in.peek() != '<') return {};
  const std::optional<dea::XmlPlaces> places = dea::find_places({std::istreambuf_iterator<char>(in), {}});
  if (!places) return {};
  std::map<std::string, ParameterInFile> parameters;
  for (const dea::XmlPlace& place : places->elements) {
    if (place.name != "contact" || place.value("type") != "dea" || place.value("name") != contact) continue;
    if (!parameters.empty()) return {};  // two of one name
    for (int child : place.children)
      parameters[places->at(child).name] = {dea::trimmed(places->content(child)), places->at(child).value("type"),
                                            places->at(child).line};
  }
  return parameters;
}

std::vector<std::string> names_of_maps(FEMesh& mesh) {
  std::vector<std::string> names;
  for (int i = 0; i < mesh.DataMaps(); ++i)
    if (dynamic_cast<FESurfaceMap*>(mesh.GetDataMap(i)) != nullptr) names.push_back(mesh.GetDataMap(i)->GetName());
  return names;
}

}  // namespace

dea::Contact FEDeaContact::statement(const dea::JointModel& model) const {
  // FEBio's accessors are not const.
  auto& self = const_cast<FEDeaContact&>(*this);
  const auto in_file = contact_in_file(model.files.front(), self.GetName());
  const auto said = [&](const std::string& name) {
    const auto place = in_file.find(name);
    return place == in_file.end() ? nullptr : &place->second;
  };
  const auto refuse_parameter = [&](const std::string& name, const std::string& what) {
    const ParameterInFile* place = said(name);
    return dea::fault_at(model, {0, place == nullptr ? 0 : place->line},
                         fmt::format("contact \"{}\": <{}>{}", self.GetName(), name, what));
  };
  for (const char* number : {"primary_E", "primary_nu", "secondary_E", "secondary_nu"}) {
    const ParameterInFile* place = said(number);
    if (place == nullptr) continue;
    try {
      dea::parse_number(place->text);
    } catch (const dea::BadValue&) {  // FEBio takes what stands before the first strange letter
      throw refuse_parameter(number,
                             fmt::format(": found \"{}\", expected a number with a decimal point", place->text));
    }
  }
  dea::Contact contact;
  contact.name = self.GetName();
  contact.type = "dea";
  const ParameterInFile* refine = said("refine");
  try {  // FEBio takes 2.5 for 2
    dea::parse_count(refine == nullptr ? std::to_string(refine_) : refine->text, 1, 1000);
  } catch (const dea::BadValue& e) {
    throw refuse_parameter("refine", fmt::format(": {}", e.what()));
  }
  dea::DeaContact dea;
  dea.law = static_cast<dea::Law>(law_);
  dea.facets = static_cast<dea::Facets>(facets_);
  dea.refine = refine_;
  dea.source = source_;
  const auto planes = dea::febio::planes_of_text(symmetry_planes_);
  if (!planes)
    throw refuse_parameter("symmetry_planes", fmt::format(": found \"{}\", {}", dea::trimmed(symmetry_planes_),
                                                          dea::febio::kPlanesExpected));
  dea.symmetry_planes = *planes;
  FEParameterList& parameters = self.GetParameterList();
  FEParamIterator parameter = parameters.first();
  for (int i = 0; i < parameters.Parameters(); ++i, ++parameter)
    if (self.GetFEModel()->GetLoadController(&*parameter) != nullptr)
      throw refuse_parameter(parameter->name(), " follows a load controller; the springs are made once, give a number");
  for (int side = 0; side < 2; ++side) {
    FEDeaSurface& surface = self.surfaces_[side];
    const std::string name = surface.GetFacetSet() != nullptr ? surface.GetFacetSet()->GetName() : surface.GetName();
    int& index = side == 0 ? contact.primary : contact.secondary;
    for (std::size_t i = 0; i < model.surfaces.size(); ++i)
      if (model.surfaces[i].name == name) index = static_cast<int>(i);
    if (index < 0)
      throw dea::fault_at(model, {0, 0},
                          fmt::format("contact \"{}\": its {} surface \"{}\" is none of the model's", self.GetName(),
                                      dea::kSides[side], name));
    dea::DeaLayer& layer = dea.layers[side];
    const std::string start = dea::kSides[side], E = start + "_E", nu = start + "_nu", tag = start + "_thickness";
    if (!(E_[side] >= 0) || std::isinf(E_[side]))
      throw refuse_parameter(E, fmt::format(": found {:g}, need E > 0", E_[side]));
    if (!(nu_[side] > -1 && nu_[side] < 0.5))
      throw refuse_parameter(nu, fmt::format(": found {:g}, need -1 < nu < 0.5", nu_[side]));
    if (E_[side] > 0 && !in_file.empty() && said(nu) == nullptr)  // FEBio's default says nothing
      throw refuse_parameter(E, fmt::format(" without <{}>; give both", nu));
    if (E_[side] > 0) {
      layer.E = E_[side];
      layer.nu = nu_[side];
    }
    const std::string given = dea::trimmed(thickness_[side]);
    FEMesh& mesh = self.GetFEModel()->GetMesh();
    const ParameterInFile* place = said(tag);
    const std::string type = place == nullptr ? "" : place->type;
    const dea::febio::ThicknessText meant = dea::febio::thickness_text(type, given);
    if (meant == dea::febio::ThicknessText::Refused)
      throw refuse_parameter(tag, fmt::format(" is given as type \"{}\", expected a number or type \"map\"", type));
    if (meant == dea::febio::ThicknessText::Number) {
      const std::optional<double> t = dea::febio::whole_double(given);
      if (!t) throw refuse_parameter(tag, fmt::format(": found \"{}\", expected a number with a decimal point", given));
      if (*t != kNotGiven && !(*t >= 0))
        throw refuse_parameter(tag, fmt::format(": found {:g}, need a thickness >= 0", *t));
      if (*t != kNotGiven) layer.thickness = *t;
    } else if (meant == dea::febio::ThicknessText::Map) {
      FEDataMap* data = mesh.FindDataMap(given);
      if (data == nullptr) {
        const std::vector<std::string> maps = names_of_maps(mesh);
        throw refuse_parameter(
            tag, fmt::format(": found \"{}\"{}, expected {}the name of a SurfaceData in MeshData (there: {})", given,
                             dea::did_you_mean(given, maps), type.empty() ? "a number with a decimal point, or " : "",
                             dea::name_list(maps, given)));
      }
      auto* map = dynamic_cast<FESurfaceMap*>(data);
      if (map == nullptr || map->StorageFormat() != FMT_MULT || map->DataType() != FE_DOUBLE)
        throw refuse_parameter(tag,
                               fmt::format(": the map \"{}\" is no SurfaceData of numbers per facet or node", given));
      const FEFacetSet* facets = map->GetFacetSet();
      if (facets == nullptr || facets->GetName() != name)
        throw refuse_parameter(tag, fmt::format(": the map \"{}\" is one of surface \"{}\", expected \"{}\"",
                                                map->GetName(), facets == nullptr ? "" : facets->GetName(), name));
      const dea::Surface& s = model.surfaces[at(index)];
      for (int f = 0; f < s.size(); ++f) {
        for (int k = 0; k < s.begin[at(f) + 1] - s.begin[at(f)]; ++k) {
          const double t = map->value<double>(f, k);
          if (!(t >= 0) || std::isinf(t))
            throw refuse_parameter(tag, fmt::format(": the map \"{}\" is {:g} at facet {}, need a thickness >= 0",
                                                    map->GetName(), t, f + 1));
          layer.thickness_map.push_back(t);
        }
      }
    }
  }
  contact.dea = dea;
  return contact;
}
