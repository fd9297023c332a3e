//! Reads the contacts of a system file.

use indexmap::IndexMap;

use super::system::Reader;
use crate::model::{
    COEFFICIENT, FRICTION_LAWS, Formula, WrittenContact, WrittenFriction, WrittenNormal, law_key,
};
use crate::study::error::{Fault, StudyError, list_names, shorten};
use crate::study::file::source::SourcePath;
use crate::study::file::system_file::{ContactEntry, FormulaText, FrictionEntry, SystemFile};

impl Reader<'_> {
    /// Reads a contact.
    pub(super) fn contact(
        &self,
        key: &str,
        entry: &ContactEntry,
        file: &SystemFile,
    ) -> Result<WrittenContact, StudyError> {
        let path = self.path(&["contacts", key]);
        let (name, index) = self.indexed(&path, key, file)?;
        let formula = |name: &str, text: &FormulaText| self.formula(&["contacts", key, name], text);
        let sliding = entry.sliding.as_ref().map(|text| formula("sliding", text)).transpose()?;
        let refuse = |problem: &str, found: &str, allowed: &str| {
            Err(path.wrong_key(problem, found, allowed))
        };
        let allowed = "`gap: ...` for a contact that opens, or `normal: ...` for a given force";
        let normal = match (&entry.gap, &entry.normal) {
            (Some(gap), None) => WrittenNormal::Gap(formula("gap", gap)?),
            (None, Some(normal)) => WrittenNormal::Given(formula("normal", normal)?),
            (Some(_), Some(_)) => {
                return refuse("two normal forces", "`gap` and `normal`", allowed);
            }
            (None, None) => {
                return refuse("no normal force", "neither `gap` nor `normal`", allowed);
            }
        };
        if sliding.is_none() && (entry.friction.is_some() || entry.normal.is_some()) {
            let allowed = "`sliding: ...`, such as x' or x' - v_belt";
            return refuse("missing key", "no `sliding`", allowed);
        }
        let has_gap = entry.gap.is_some();
        if entry.restitution.is_some() && !has_gap
            || entry.tangential_restitution.is_some() && !(has_gap && sliding.is_some())
        {
            let allowed =
                "`restitution` only with `gap`, and `tangential_restitution` also with `sliding`";
            return refuse(
                "a restitution without an impact",
                "no gap or no sliding speed",
                allowed,
            );
        }
        let has_law_of_study = matches!(entry.friction, Some(FrictionEntry(None)));
        let laws = entry.friction.as_ref().and_then(|FrictionEntry(laws)| laws.as_ref());
        let friction = laws.map(|laws| self.friction(&path.key("friction"), key, laws));
        let friction = friction.transpose()?;
        let or_zero = |name: &str, text: &Option<FormulaText>| {
            text.as_ref().map_or(Ok(Formula::number(0.0)), |text| formula(name, text))
        };
        let restitution = [
            or_zero("restitution", &entry.restitution)?,
            or_zero("tangential_restitution", &entry.tangential_restitution)?,
        ];
        Ok(WrittenContact { name, index, sliding, normal, friction, has_law_of_study, restitution })
    }

    /// Reads the law of friction of a contact.
    fn friction(
        &self,
        path: &SourcePath<'_>,
        key: &str,
        laws: &IndexMap<String, IndexMap<String, FormulaText>>,
    ) -> Result<WrittenFriction, StudyError> {
        let names: Vec<&str> = FRICTION_LAWS.iter().map(|law| law.name()).collect();
        let Some((name, values)) = laws.iter().next().filter(|_| laws.len() == 1) else {
            let (found, allowed) =
                (format!("{} laws", laws.len()), format!("one of {}", names.join(", ")));
            return Err(path.wrong_value("not one law of friction", found, allowed));
        };
        let path = path.key(name);
        let Some(law) = FRICTION_LAWS.iter().find(|law| law.name() == name) else {
            let allowed = list_names(name, &names);
            return Err(path.wrong_key("unknown choice", shorten(name), allowed));
        };
        let has_coefficient = law.uses_friction_coefficient();
        let of_law = law.parameters().iter().map(law_key);
        let keys: Vec<&str> =
            has_coefficient.then_some(COEFFICIENT).into_iter().chain(of_law).collect();
        if let Some(unknown) = values.keys().find(|key| !keys.contains(&key.as_str())) {
            let fault = Fault::new("unknown key", shorten(unknown), list_names(unknown, &keys));
            return Err(path.key(unknown).refuse_key(fault));
        }
        let value = |law_key: &str| match values.get(law_key) {
            Some(text) => self.formula(&["contacts", key, "friction", name, law_key], text),
            None => {
                let allowed = format!("a value for `{law_key}`");
                Err(path.wrong_key("missing key", "no such key", allowed))
            }
        };
        let coefficient = if has_coefficient { value(COEFFICIENT)? } else { Formula::number(0.0) };
        let formulas = law.parameters().iter().map(|parameter| value(law_key(parameter)));
        let values = formulas.collect::<Result<_, _>>()?;
        Ok(WrittenFriction { law: *law, coefficient, values })
    }
}
