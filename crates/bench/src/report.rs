//! Tables for people, in Markdown, to be pasted where they are needed.

use crate::embree::Setup;
use crate::kernels::Work;

/// Speeds of one kind of ray on one mesh.
pub(crate) struct Speeds {
    /// The mesh's name.
    pub(crate) mesh: String,
    /// The kind of ray.
    pub(crate) work: Work,
    /// Threads that traced.
    pub(crate) threads: usize,
    /// Ours: each level of this processor, with its millions of rays per second.
    pub(crate) levels: Vec<(String, f64)>,
    /// Embree's best mode, by default and watertight, with its millions of rays per second.
    pub(crate) embree: Vec<(String, f64)>,
}

impl Speeds {
    /// Our best level over Embree's best mode, by default and watertight.
    pub(crate) fn ratios(&self) -> Vec<f64> {
        let ours = self.levels.last().map_or(0.0, |(_, speed)| *speed);
        self.embree.iter().map(|(_, theirs)| ours / theirs).collect()
    }

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![self.work.name().into(), self.mesh.clone(), self.threads.to_string()];
        cells.extend(self.levels.iter().map(|(_, speed)| format!("{speed:.2}")));
        for ((mode, speed), ratio) in self.embree.iter().zip(self.ratios()) {
            cells.extend([format!("{speed:.2}"), mode.clone(), format!("**{ratio:.2}**")]);
        }
        cells
    }
}

/// How far our hits and Embree's are the same.
pub(crate) struct Agreement {
    mesh: String,
    work: Work,
    theirs: Setup,
    rays: usize,
    /// Rays that hit, ours and Embree's.
    hits: [usize; 2],
    /// Rays that hit something in one of both only.
    only_one_hits: usize,
    /// Rays whose distances differ by more than [`ROUNDING`].
    elsewhere: usize,
    /// The largest relative difference of distances below that.
    rounding: f32,
}

/// The relative difference of distances up to which both are taken to have hit the same place.
const ROUNDING: f32 = 1e-4;

impl Agreement {
    /// Compares the distances that both found.
    pub(crate) fn new(mesh: &str, work: Work, theirs: Setup, a: &[f32], b: &[f32]) -> Self {
        let pairs = || a.iter().zip(b);
        let both = || pairs().filter(|(a, b)| a.is_finite() && b.is_finite());
        let differences = || both().map(|(a, b)| (a - b).abs() / a.max(*b).max(f32::MIN_POSITIVE));
        Self {
            mesh: mesh.into(),
            work,
            theirs,
            rays: a.len(),
            hits: [a, b].map(|t| t.iter().filter(|t| t.is_finite()).count()),
            only_one_hits: pairs().filter(|(a, b)| a.is_finite() != b.is_finite()).count(),
            elsewhere: differences().filter(|d| *d > ROUNDING).count(),
            rounding: differences().filter(|d| *d <= ROUNDING).fold(0.0, f32::max),
        }
    }

    fn cells(&self) -> Vec<String> {
        let theirs = if self.theirs.robust { "robust" } else { "default" };
        let mut cells = vec![self.work.name().into(), self.mesh.clone(), theirs.into()];
        let counts = [self.rays, self.hits[0], self.hits[1], self.only_one_hits, self.elsewhere];
        cells.extend(counts.map(|count| count.to_string()));
        cells.push(format!("{:.1e}", self.rounding));
        cells
    }
}

/// What has been measured. Speeds are printed as they come.
#[derive(Default)]
pub(crate) struct Report {
    /// How fast rays were.
    pub(crate) speeds: Vec<Speeds>,
    /// How far hits agree.
    pub(crate) agreements: Vec<Agreement>,
}

impl Report {
    /// Takes speeds in and prints them, after the table's head if they are the first.
    pub(crate) fn add(&mut self, speeds: Speeds) {
        if self.speeds.is_empty() {
            println!("Millions of rays per second, medians; ratio: ours to Embree's best mode.\n");
            print_head(&head(&speeds));
        }
        print_row(&speeds.cells());
        self.speeds.push(speeds);
    }

    /// Prints the means and how far hits agree.
    pub(crate) fn finish(&self) {
        if self.speeds.iter().any(|speeds| !speeds.embree.is_empty()) {
            self.print_means();
            self.print_agreements();
        }
    }

    fn print_means(&self) {
        println!("\nOurs to Embree's best mode, geometric means over the meshes.\n");
        print_head(&["rays", "threads", "default", "robust"].map(String::from));
        for (work, threads, means) in self.means() {
            let mut cells = vec![work.name().into(), threads.to_string()];
            cells.extend(means.iter().map(|mean| format!("{mean:.2}")));
            print_row(&cells);
        }
    }

    /// For each kind of ray and number of threads the geometric mean of the ratios over the meshes.
    pub(crate) fn means(&self) -> Vec<(Work, usize, Vec<f64>)> {
        let mut means: Vec<(Work, usize, Vec<f64>)> = Vec::new();
        for speeds in &self.speeds {
            if !means.iter().any(|(work, threads, _)| (*work, *threads) == speeds.key()) {
                means.push((speeds.work, speeds.threads, self.mean(speeds.key())));
            }
        }
        means
    }

    fn mean(&self, key: (Work, usize)) -> Vec<f64> {
        let ratios: Vec<Vec<f64>> =
            self.speeds.iter().filter(|s| s.key() == key).map(Speeds::ratios).collect();
        let columns = ratios.first().map_or(0, Vec::len);
        let mean = |column| {
            let logs: f64 = ratios.iter().map(|row| f64::ln(row[column])).sum();
            (logs / ratios.len() as f64).exp()
        };
        (0..columns).map(mean).collect()
    }

    fn print_agreements(&self) {
        println!("\nHits beside Embree's: one ray after the other.\n");
        let head = [
            "rays",
            "mesh",
            "Embree",
            "rays",
            "hits",
            "Embree's hits",
            "only one hits",
            "another distance",
            "largest other difference",
        ];
        print_head(&head.map(String::from));
        self.agreements.iter().for_each(|agreement| print_row(&agreement.cells()));
    }
}

impl Speeds {
    fn key(&self) -> (Work, usize) {
        (self.work, self.threads)
    }
}

fn head(speeds: &Speeds) -> Vec<String> {
    let mut head = ["rays", "mesh", "threads"].map(String::from).to_vec();
    head.extend(speeds.levels.iter().map(|(level, _)| level.clone()));
    for (embree, _) in ["Embree", "Embree robust"].iter().zip(&speeds.embree) {
        head.extend([(*embree).into(), "its mode".into(), "ratio".into()]);
    }
    head
}

/// Prints the head of a table.
pub(crate) fn print_head(cells: &[String]) {
    print_row(cells);
    println!("|{}", "---|".repeat(cells.len()));
}

/// Prints a row of a table.
pub(crate) fn print_row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::Quality;

    #[test]
    fn hits_are_compared_one_by_one() {
        let setup = Setup { quality: Quality::High, robust: true, simd256: false };
        let nothing = f32::INFINITY;
        let ours = [nothing, nothing, 1.0, 2.0, 3.0, 0.0];
        let theirs = [nothing, 1.0, nothing, 2.000_02, 4.0, 0.0];
        let compared = Agreement::new("mesh", Work::Camera, setup, &ours, &theirs);
        assert_eq!(compared.hits, [4, 4]);
        assert_eq!((compared.only_one_hits, compared.elsewhere), (2, 1));
        assert!(compared.rounding > 5e-6 && compared.rounding < 2e-5);
    }

    #[test]
    fn means_are_geometric_and_apart_for_each_number_of_threads() {
        let mut report = Report::default();
        for (mesh, threads, ours) in [("a", 1, 2.0), ("b", 1, 8.0), ("a", 2, 3.0)] {
            let levels = vec![("portable".into(), 0.5), ("best".into(), ours)];
            let embree = vec![("8".into(), 2.0)];
            let mesh = mesh.into();
            report.speeds.push(Speeds { mesh, work: Work::Shadow, threads, levels, embree });
        }
        let means = report.means();
        assert_eq!((means.len(), means[0].1, means[1].1), (2, 1, 2));
        assert!((means[0].2[0] - 2.0).abs() < 1e-12);
        assert!((means[1].2[0] - 1.5).abs() < 1e-12);
    }
}
