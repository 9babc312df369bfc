"""The planner that needs no model: a sentence becomes a plan by rules, with no word left over.

1. `tokens` are entries of the `lexicon` and numbers with units; `grammar` reads them into clauses of `phrases`.
2. `meaning` reads clause by clause: the `reader` knows which thing a phrase means, `places` where it is, `actions`
   (with `goes`, `falls`, `wheels`) what it does. What comes of it is the `cast`; `used` refuses what nothing comes of.
3. `scenes/` build parts of the plan from the cast, one file a kind of scene; `sizes` makes each thing's objects.
4. `planner` sets the parts side by side, lays them out, adds cameras, `steps` and what was assumed; `questions` asks
   about that. `words` says what it knows.
5. `built` reads the whole plan against the cast, and refuses what was lost on the way; `ties` lets what is asked of a
   thing, and of no other, answer for each verb that is said of it.

A word or a material is added in `language/*.toml`; a verb there, in verbs.toml, and with a function in `actions`; a
scene as a function of `scenes/` that `planner` calls.
"""
