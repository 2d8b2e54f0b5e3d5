// A plugin for tests: writes FEBio's model, as read_fe_model sees it, to the task's control file. Task dea_dump reads
// it before FEModel::Init, dea_dump_in_init from the Init of the model's last component.
#include <FECore/CompactUnSymmMatrix.h>
#include <FECore/FECoreKernel.h>
#include <FECore/FECoreTask.h>
#include <FECore/FEModel.h>
#include <FECore/FENLConstraint.h>
#include <FECore/LinearSolver.h>
#include <FECore/sdk.h>
#include <FECore/version.h>

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <cstdio>
#include <fstream>
#include <string>

#include "plugin/read_fe_model.h"
#include "tests/plugin/model_dump.h"

namespace {

bool write_dump(FEModel& fem, const std::string& path) {
  std::string text;
  try {
    text = dea::test::dump(dea::read_fe_model(fem));
  } catch (const std::exception& e) {
    text = std::string("fault ") + e.what() + "\n";
  }
  std::ofstream file(path, std::ios::binary);
  file << text;
  return file.good();
}

/// A linear solver for matrices without symmetry: a FEBio built without MKL has none that serves.
class SparseLuSolver : public LinearSolver {
 public:
  explicit SparseLuSolver(FEModel* fem) : LinearSolver(fem) {}
  SparseMatrix* CreateSparseMatrix(Matrix_Type) override { return matrix_ = new CCSSparseMatrix(0); }
  bool SetSparseMatrix(SparseMatrix* matrix) override {
    matrix_ = dynamic_cast<CCSSparseMatrix*>(matrix);
    return matrix_ != nullptr;
  }
  bool Factor() override {
    const Eigen::Map<const Eigen::SparseMatrix<double>> a(matrix_->Rows(), matrix_->Columns(), matrix_->NonZeroes(),
                                                          matrix_->Pointers(), matrix_->Indices(), matrix_->Values());
    lu_.compute(a);
    return lu_.info() == Eigen::Success;
  }
  bool BackSolve(double* x, double* y) override {
    const int n = matrix_->Rows();
    Eigen::Map<Eigen::VectorXd>(x, n) = lu_.solve(Eigen::Map<Eigen::VectorXd>(y, n));
    UpdateStats(0);
    return lu_.info() == Eigen::Success;
  }

 private:
  CCSSparseMatrix* matrix_ = nullptr;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
};

class DumpTask : public FECoreTask {
 public:
  explicit DumpTask(FEModel* fem) : FECoreTask(fem) {}
  bool Init(const char* file) override {
    path_ = file;
    return true;
  }
  bool Run() override { return write_dump(*GetFEModel(), path_); }

 protected:
  std::string path_;
};

class Dumper : public FENLConstraint {
 public:
  Dumper(FEModel* fem, const std::string& path) : FENLConstraint(fem), path_(path) {}
  bool Init() override {
    done = write_dump(*GetFEModel(), path_);
    return false;  // no more of it
  }
  void LoadVector(FEGlobalVector&, const FETimeInfo&) override {}
  void StiffnessMatrix(FELinearSystem&, const FETimeInfo&) override {}
  void BuildMatrixProfile(FEGlobalMatrix&) override {}
  bool done = false;

 private:
  std::string path_;
};

class DumpInInitTask : public DumpTask {
 public:
  explicit DumpInInitTask(FEModel* fem) : DumpTask(fem) {}
  bool Run() override {
    auto* dumper = new Dumper(GetFEModel(), path_);
    GetFEModel()->AddNonlinearConstraint(dumper);
    GetFEModel()->Init();
    return dumper->done;
  }
};

}  // namespace

FECORE_PLUGIN unsigned int GetSDKVersion() { return FE_SDK_VERSION; }

FECORE_PLUGIN void PluginInitialize(FECoreKernel& kernel) {
  FECoreKernel::SetInstance(&kernel);
  REGISTER_FECORE_CLASS(SparseLuSolver, "sparse_lu");
  REGISTER_FECORE_CLASS(DumpTask, "dea_dump");
  REGISTER_FECORE_CLASS(DumpInInitTask, "dea_dump_in_init");
}
